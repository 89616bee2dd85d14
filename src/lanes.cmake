# The kernels of robots in SIMD lanes (src/dynamics/lanes) and of panels (sparse/src/panels), compiled once per level of
# instructions and chosen when the program runs. A level above the compiler's own is linked by itself, and of its symbols
# only the level stays visible: were Eigen's and std's functions in it shared with the rest of the program, the linker
# might take those that the processor at hand does not have.
option(MANYCONTACT_LANES "Compile kernels for AVX2 and AVX-512 too, where the compiler and GNU binutils can" ON)

set(lane_levels baseline)
set(lane_width_baseline 2)
set(lane_flags_baseline)
set(lane_width_avx2 4)
set(lane_flags_avx2 -mavx2 -mfma)
set(lane_width_avx512 8)
set(lane_flags_avx512 -mavx512f -mavx512dq -mavx512vl -mavx512bw -mavx512cd -mavx2 -mfma -mprefer-vector-width=512)

# Copies of what is many lanes wide, by whole registers: a load of one waits long for what was stored in pieces.
include(CheckCXXCompilerFlag)
check_cxx_compiler_flag(-mmove-max=256 MANYCONTACT_MOVES_BY_REGISTERS)
if(MANYCONTACT_MOVES_BY_REGISTERS)  # GCC 12
  list(APPEND lane_flags_avx2 -mmove-max=256 -mstore-max=256)
  list(APPEND lane_flags_avx512 -mmove-max=512 -mstore-max=512)
endif()

# Sanitizers keep tables of a file's symbols, which would no longer fit.
if(MANYCONTACT_LANES AND CMAKE_SYSTEM_PROCESSOR MATCHES "^(x86_64|AMD64)$" AND CMAKE_LINKER AND CMAKE_OBJCOPY
   AND NOT MANYCONTACT_FUZZ AND NOT CMAKE_CXX_FLAGS MATCHES "-fsanitize|--coverage")
  execute_process(COMMAND ${CMAKE_LINKER} --help OUTPUT_VARIABLE linker_help ERROR_QUIET)
  if(linker_help MATCHES "--force-group-allocation")
    list(APPEND lane_levels avx2 avx512)
  endif()
endif()

# add_levels(TARGET SOURCE FILE [SEES LIBRARY...] [LEVELS LEVEL...]): puts FILE, compiled for each of the levels (all of
# them) that the compiler has, into a static library. SEES: libraries whose headers it includes.
function(add_levels target)
  cmake_parse_arguments(PARSE_ARGV 1 at "" "SOURCE" "SEES;LEVELS")
  foreach(level IN LISTS lane_levels)
    if(at_LEVELS AND NOT level IN_LIST at_LEVELS)
      continue()
    endif()
    set(objects ${target}_${level})
    add_library(${objects} OBJECT ${at_SOURCE})
    set_target_properties(${objects} PROPERTIES UNITY_BUILD OFF)
    target_compile_options(${objects} PRIVATE ${own_flags} -Wno-psabi -ffp-contract=off ${lane_flags_${level}})
    target_compile_definitions(${objects} PRIVATE MANYCONTACT_LEVEL=${level} MANYCONTACT_LANES=${lane_width_${level}})
    foreach(library IN LISTS at_SEES)
      target_compile_definitions(${objects} PRIVATE $<TARGET_PROPERTY:${library},INTERFACE_COMPILE_DEFINITIONS>)
    endforeach()
    target_link_libraries(${objects} PRIVATE ${at_SEES})
    target_include_directories(${objects} PRIVATE ${PROJECT_SOURCE_DIR}/sparse/include)
    target_compile_features(${objects} PRIVATE cxx_std_20)
    target_compile_definitions(${target} PRIVATE MANYCONTACT_LEVEL_${level})
    if(level STREQUAL "baseline")
      target_sources(${target} PRIVATE $<TARGET_OBJECTS:${objects}>)
      continue()
    endif()
    # Vectors of the level's width want their own alignment; no memory of Eigen's crosses the border.
    target_compile_options(${objects} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-fno-gnu-unique> -UEIGEN_MAX_ALIGN_BYTES -UEIGEN_MAX_STATIC_ALIGN_BYTES
                           -DEIGEN_MAX_ALIGN_BYTES=64 -DEIGEN_MAX_STATIC_ALIGN_BYTES=64)
    set(alone ${PROJECT_BINARY_DIR}/${objects}.o)
    add_custom_command(OUTPUT ${alone}
      COMMAND ${CMAKE_LINKER} -r --force-group-allocation $<TARGET_OBJECTS:${objects}> -o ${alone}
      COMMAND ${CMAKE_OBJCOPY} --wildcard "--keep-global-symbol=*level_${level}*" ${alone}
      DEPENDS ${objects} $<TARGET_OBJECTS:${objects}>
      COMMENT "Hiding all but the level of ${objects}.o" VERBATIM)
    set_source_files_properties(${alone} PROPERTIES EXTERNAL_OBJECT ON GENERATED ON)
    target_sources(${target} PRIVATE ${alone})
  endforeach()
endfunction()
