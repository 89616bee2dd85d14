# The way out for programs compiled for this processor: a library configured for their alignment takes them, refuses
# others, and names definitions with which it takes those too. Headers only; nothing is built.
#   CXX, LIBRARY_FLAGS, EIGEN, CONSUMER, CONFIGURE as in flags.cmake; PROJECT, BUILD: the library's source, a build folder
include(${CMAKE_CURRENT_LIST_DIR}/eigen_memory.cmake)
eigen_memory("" plain)
eigen_memory("-march=native" native)
if(native STREQUAL plain)
  message("skipped: this processor's vectors have no wider alignment than any other's")
  return()
endif()

file(REMOVE_RECURSE ${BUILD})
execute_process(COMMAND ${CMAKE_COMMAND} -S ${PROJECT} -B ${BUILD} ${CONFIGURE}
                        -DMANYCONTACT_EIGEN_MAX_ALIGN_BYTES=${native_max_align}
                        -DMANYCONTACT_TESTS=OFF -DMANYCONTACT_BENCH=OFF
                OUTPUT_QUIET COMMAND_ERROR_IS_FATAL ANY)

# Sets errors to the compiler's messages on main.cpp with these flags.
function(compile)
  execute_process(COMMAND ${CXX} -std=c++20 -fsyntax-only ${ARGN} -I${BUILD}/include -I${PROJECT}/include
                          -isystem ${EIGEN} ${CONSUMER}/main.cpp
                  ERROR_VARIABLE errors)
  set(errors "${errors}" PARENT_SCOPE)
endfunction()
function(expect_taken)
  compile(${ARGN})
  if(errors)
    message(FATAL_ERROR "with ${ARGN}: ${errors}")
  endif()
endfunction()

expect_taken(-march=native)
expect_taken(-march=native -fsanitize=address)
compile()
if(NOT errors MATCHES "built with EIGEN_MAX_ALIGN_BYTES=${native_max_align} .*, this file with [0-9]+ .*: compile all")
  message(FATAL_ERROR "compiled plain it should be refused:\n${errors}")
endif()
string(REGEX MATCHALL "-DEIGEN_[A-Z_]+=[0-9]+" remedy "${errors}")
list(REMOVE_DUPLICATES remedy)
expect_taken(${remedy})
expect_taken(${remedy} -fsanitize=address)
message("configured for ${native_max_align} bytes it takes -march=native, and others with ${remedy}")
