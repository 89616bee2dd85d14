# Kernels for panels and dense blocks (sparse) and SIMD batches of robots (dynamics), for several SIMD levels, one of
# which levels.cpp chooses at run time. Each level above the compiler's own is linked separately, and only symbols named
# after it stay visible: the linker might otherwise take Eigen's and std's functions from this level everywhere.
option(MANYCONTACT_LANES "Compile kernels for AVX2 and AVX-512, where the compiler and GNU binutils can" ON)
option(MANYCONTACT_PORTABLE "Compile the kernels of all levels of instructions, not of this machine alone" OFF)

set(lane_width_baseline 2)
set(lane_flags_baseline)
set(lane_width_avx2 4)
set(lane_flags_avx2 -mavx2 -mfma)
set(lane_width_avx512 8)
set(lane_flags_avx512 -mavx512f -mavx512dq -mavx512vl -mavx512bw -mavx512cd -mavx2 -mfma -mprefer-vector-width=512)

# Copies wide packs by whole registers: loading a pack stalls after it was stored in pieces.
include(CheckCXXCompilerFlag)
check_cxx_compiler_flag(-mmove-max=256 MANYCONTACT_MOVES_BY_REGISTERS)
if(MANYCONTACT_MOVES_BY_REGISTERS)  # GCC 12
  list(APPEND lane_flags_avx2 -mmove-max=256 -mstore-max=256)
  list(APPEND lane_flags_avx512 -mmove-max=512 -mstore-max=512)
endif()

# No levels with sanitizers: their tables of a file's symbols would not fit after the separate linking.
set(lane_levels baseline)
if(MANYCONTACT_LANES AND CMAKE_SYSTEM_PROCESSOR MATCHES "^(x86_64|AMD64)$" AND CMAKE_LINKER AND CMAKE_OBJCOPY
   AND NOT MANYCONTACT_FUZZ AND NOT CMAKE_CXX_FLAGS MATCHES "-fsanitize|--coverage")
  execute_process(COMMAND ${CMAKE_LINKER} --help OUTPUT_VARIABLE linker_help ERROR_QUIET)
  if(linker_help MATCHES "--force-group-allocation")
    list(APPEND lane_levels avx2 avx512)
  endif()
endif()
if(NOT MANYCONTACT_PORTABLE AND NOT CMAKE_CROSSCOMPILING)
  include(CheckCXXSourceRuns)
  foreach(level IN LISTS lane_levels)
    set(MANYCONTACT_RUNS_baseline ON)
    if(NOT level STREQUAL "baseline")
      file(READ ${CMAKE_CURRENT_LIST_DIR}/runs.hpp runs)
      check_cxx_source_runs("${runs} int main() { return manycontact::simd::runs_${level}() ? 0 : 1; }"
                            MANYCONTACT_RUNS_${level})
    endif()
    if(MANYCONTACT_RUNS_${level})
      set(highest ${level})
    endif()
  endforeach()
  set(lane_levels ${highest})
endif()

# Sources of SIMD batches: first the templates of the forward path, then the batches, as one unit. It instantiates the
# templates for packs of the level's width and for packs of one robot.
set(robot_sources src/core/algorithm/crba.cpp src/core/algorithm/kinematics.cpp src/core/algorithm/rnea.cpp
                  src/core/algorithm/rnea_derivatives.cpp src/core/algorithm/rnea_products.cpp
                  src/core/contact/derivatives.cpp src/core/contact/pair_motion.cpp src/core/contact/products.cpp src/core/contact/rows.cpp
                  src/core/dynamics/lanes/level.cpp)
set(panel_sources sparse/src/panels/level.cpp)
set(block_sources sparse/src/blocks/level.cpp)
# Sources for the precision `extended`: the same templates in double-double.
set(extended_sources src/core/algorithm/applied_forces.cpp src/core/algorithm/kinematics.cpp src/core/algorithm/rnea.cpp
                     src/core/contact/pair_motion.cpp src/core/contact/rows.cpp src/core/dynamics/extended/level.cpp)
# Sources for single precision: islands of one robot in floats, with twice as many robots in a register.
set(single_sources src/core/algorithm/crba.cpp src/core/algorithm/kinematics.cpp src/core/algorithm/rnea.cpp
                   src/core/contact/pair_motion.cpp src/core/contact/rows.cpp src/core/dynamics/lanes/single.cpp)
# Both lists once more for packs of one robot, as the level one_LEVEL; compiled separately, they take half the memory.
set(one_robot_sources ${robot_sources})
set(one_single_sources ${single_sources})

# The static library manycontact_kernels. Its kernels and the modules call each other, which static libraries may do.
target_link_libraries(manycontact INTERFACE manycontact_kernels)
if(MANYCONTACT_FUZZ_LINKS)
  built_module(kernels manycontact_kkt)
  return()
endif()
add_library(manycontact_kernels STATIC src/core/simd/levels.cpp)
add_library(manycontact::kernels ALIAS manycontact_kernels)
set_target_properties(manycontact_kernels PROPERTIES EXPORT_NAME kernels UNITY_BUILD OFF)
target_compile_options(manycontact_kernels PRIVATE ${own_flags})
target_compile_features(manycontact_kernels PRIVATE cxx_std_20)
target_link_libraries(manycontact_kernels PUBLIC manycontact_kkt)
# kernels(KIND LEVEL): the object library KIND_kernels_LEVEL, whose objects join objects_LEVEL.
function(kernels kind level)
  set(target ${kind}_kernels_${level})
  if(TARGET ${target})
    return()
  endif()
  add_library(${target} OBJECT ${${kind}_sources})
  add_dependencies(manycontact_kernels ${target})  # Makefiles do not see this dependency through the objects
  set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE 0)
  target_compile_options(${target} PRIVATE ${own_flags} -Wno-psabi -ffp-contract=off ${lane_flags_${level}})
  set(one)
  if(kind MATCHES "^one_")
    set(one one_)
  endif()
  target_compile_definitions(${target} PRIVATE MANYCONTACT_LEVEL=${one}${level})
  set(max_align 64)
  set(static_align 64)
  if(kind STREQUAL "extended")  # no packs here: headers, alignment and memory are the library's
    set(max_align ${abi_max_align})
    set(static_align ${abi_static_align})
    target_compile_definitions(${target} PRIVATE $<$<NOT:$<STREQUAL:${level},baseline>>:EIGEN_DONT_VECTORIZE>)
  else()
    set(pack ${lane_width_${level}})
    if(kind STREQUAL "single")
      math(EXPR pack "2 * ${pack}")
    endif()
    if(one)
      set(pack 1)
    endif()
    if(kind MATCHES "single")
      string(APPEND pack ",float")
    endif()
    target_compile_definitions(${target} PRIVATE MANYCONTACT_LANES=${pack})
  endif()
  target_include_directories(${target} PRIVATE include ${PROJECT_BINARY_DIR}/include)
  target_link_libraries(${target} PRIVATE Eigen3::Eigen)
  target_compile_features(${target} PRIVATE cxx_std_20)
  if(NOT level STREQUAL "baseline")
    # Vectors of the level need their own alignment. No memory that Eigen allocates passes between levels and library.
    target_compile_options(${target} PRIVATE
      $<$<CXX_COMPILER_ID:GNU>:-fno-gnu-unique> -UEIGEN_MAX_ALIGN_BYTES -UEIGEN_MAX_STATIC_ALIGN_BYTES
      -DEIGEN_MAX_ALIGN_BYTES=${max_align} -DEIGEN_MAX_STATIC_ALIGN_BYTES=${static_align}
      $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized>)  # GCC 12 warns about its own AVX-512 header
  endif()
  set(objects_${level} ${objects_${level}} $<TARGET_OBJECTS:${target}> PARENT_SCOPE)
endfunction()

foreach(level IN LISTS lane_levels)
  target_compile_definitions(manycontact_kernels PRIVATE MANYCONTACT_LEVEL_${level})
  foreach(kind IN ITEMS robot panel single one_robot one_single)
    kernels(${kind} ${level})
  endforeach()
  string(REPLACE "avx512" "avx2" narrow ${level})  # dense blocks and double-double gain nothing from AVX-512
  foreach(kind IN ITEMS block extended)
    kernels(${kind} ${narrow})
  endforeach()
endforeach()
target_sources(manycontact_kernels PRIVATE ${objects_baseline})
foreach(level IN ITEMS avx2 avx512)
  if(NOT objects_${level})
    continue()
  endif()
  set(alone ${PROJECT_BINARY_DIR}/kernels_${level}.o)
  add_custom_command(OUTPUT ${alone}
    COMMAND ${CMAKE_LINKER} -r --force-group-allocation ${objects_${level}} -o ${alone}
    COMMAND ${CMAKE_OBJCOPY} --wildcard "--keep-global-symbol=*level_${level}*"
            "--keep-global-symbol=*level_one_${level}*" ${alone}
    DEPENDS ${objects_${level}} COMMAND_EXPAND_LISTS
    COMMENT "Hiding all but the levels of kernels_${level}.o" VERBATIM)
  set_source_files_properties(${alone} PROPERTIES EXTERNAL_OBJECT ON GENERATED ON)
  target_sources(manycontact_kernels PRIVATE ${alone})
endforeach()
