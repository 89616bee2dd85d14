# The parts that projects of this tree share: the flags of their own files, and the function module.

# Our own files only; dependencies come in as system headers. Never -ffast-math: the residuals and the refinement
# rely on IEEE arithmetic. Nobody here reads errno after sqrt.
set(own_flags -Wall -Wextra -Wpedantic -fno-math-errno)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
  list(APPEND own_flags -Wno-restrict)  # GCC 12 warns of "text" + string by mistake (its bug 105651)
endif()

get_filename_component(manycontact_top ${CMAKE_CURRENT_LIST_DIR}/.. ABSOLUTE)

# module(NAME FOLDER [ON lower modules...] [PRIVATE what this module alone may see...]) is the static library
# manycontact_NAME of FOLDER/**/*.cpp, or an interface library where a module has headers alone. Its public headers are in
# ${manycontact_headers}. It links the modules it names, by ${manycontact_prefix}NAME, and what those link;
# tests/layering_test.cpp checks the includes. The global property manycontact_modules lists all modules.
function(module name folder)
  cmake_parse_arguments(PARSE_ARGV 2 arg "" "" "ON;PRIVATE")
  set(target manycontact_${name})
  list(TRANSFORM arg_ON PREPEND ${manycontact_prefix})
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS ${folder}/*.cpp)
  list(FILTER sources EXCLUDE REGEX "/(level|single)\\.cpp$")  # compiled once per level: src/core/simd/levels.cmake
  if(MANYCONTACT_FUZZ_LINKS AND sources AND NOT name STREQUAL "io")
    built_module(${name} ${arg_ON} ${arg_PRIVATE})
    return()
  endif()
  if(sources)
    set(scope PUBLIC)
    add_library(${target} STATIC ${sources})
    set_target_properties(${target} PROPERTIES ARCHIVE_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR})
    target_compile_options(${target} PRIVATE ${own_flags})
    target_link_libraries(${target} PRIVATE ${arg_PRIVATE})
    if(NOT CMAKE_CURRENT_SOURCE_DIR STREQUAL manycontact_top OR folder MATCHES "^src/tools/")
      set_target_properties(${target} PROPERTIES UNITY_BUILD_BATCH_SIZE 12)
    endif()
    if(name MATCHES "^(io|analysis|task)$")  # no loops over numbers; action, lq and control lose a tenth of their speed by -O2
      target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:-O2>)
    endif()
  else()
    set(scope INTERFACE)
    add_library(${target} INTERFACE)
  endif()
  add_library(manycontact::${name} ALIAS ${target})
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${name})
  target_link_libraries(${target} ${scope} Eigen3::Eigen ${arg_ON})
  target_include_directories(${target} ${scope} $<BUILD_INTERFACE:${manycontact_headers}>
                                                $<BUILD_INTERFACE:${PROJECT_BINARY_DIR}/include>
                                                $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  target_compile_features(${target} ${scope} cxx_std_20)
  set_property(GLOBAL APPEND PROPERTY manycontact_modules ${target})
endfunction()
