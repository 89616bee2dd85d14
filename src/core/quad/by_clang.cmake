# The sources of the directory that includes this are compiled by MANYCONTACT_TESTS_CLANG, where that is set and the
# compiler is GCC. clang takes GCC's options, standard library and precompiled headers' file names; GCC links.
if(NOT MANYCONTACT_TESTS_CLANG OR NOT CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  return()
endif()
string(REPLACE "<CMAKE_CXX_COMPILER>" "${MANYCONTACT_TESTS_CLANG}" CMAKE_CXX_COMPILE_OBJECT
               "${CMAKE_CXX_COMPILE_OBJECT}")
list(REMOVE_ITEM own_flags -Wno-restrict)
list(APPEND own_flags -fpch-instantiate-templates)

# quadmath.h alone of the headers that GCC keeps for itself.
set(quadmath ${PROJECT_BINARY_DIR}/quadmath)
if(NOT EXISTS ${quadmath}/quadmath.h)
  execute_process(COMMAND ${CMAKE_CXX_COMPILER} -print-file-name=include/quadmath.h OUTPUT_VARIABLE header
                  OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY)
  file(COPY ${header} DESTINATION ${quadmath})
endif()
include_directories(SYSTEM ${quadmath})
