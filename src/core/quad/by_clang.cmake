# MANYCONTACT_TESTS_CLANG, if set, compiles the sources of the including directory in place of GCC. clang accepts GCC's
# options, standard library and names of precompiled headers; GCC links.
if(NOT MANYCONTACT_TESTS_CLANG OR NOT CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  return()
endif()
string(REPLACE "<CMAKE_CXX_COMPILER>" "${MANYCONTACT_TESTS_CLANG}" CMAKE_CXX_COMPILE_OBJECT
               "${CMAKE_CXX_COMPILE_OBJECT}")
list(REMOVE_ITEM own_flags -Wno-restrict)
# clang warns of members without initializers even if they have default values.
list(APPEND own_flags -fpch-instantiate-templates -Wno-missing-field-initializers)

# The only header of GCC that clang uses here is quadmath.h; other headers of GCC are its own.
set(quadmath ${PROJECT_BINARY_DIR}/quadmath)
if(NOT EXISTS ${quadmath}/quadmath.h)
  execute_process(COMMAND ${CMAKE_CXX_COMPILER} -print-file-name=include/quadmath.h OUTPUT_VARIABLE header
                  OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY)
  file(COPY ${header} DESTINATION ${quadmath})
endif()
include_directories(SYSTEM ${quadmath})
