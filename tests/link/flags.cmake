# main.cpp built with flags of its own. Where Eigen makes the same of them as of the library's, it must run; where not, or
# where REFUSED says so, one line must say what differs and what to do.
#   CXX, LIBRARY_FLAGS, FLAGS, EIGEN: compiler, flags of the library and of the program beside them, Eigen's folder
#   CONSUMER, BUILD, CONFIGURE: its source and build folders, what else to configure with
#   SCENE, PRINTS: what to run it on, and what it prints (a regular expression)
include(${CMAKE_CURRENT_LIST_DIR}/eigen_memory.cmake)
eigen_memory("${LIBRARY_FLAGS}" library)
eigen_memory("${LIBRARY_FLAGS} ${FLAGS}" program)

file(REMOVE_RECURSE ${BUILD})
execute_process(COMMAND ${CMAKE_COMMAND} -S ${CONSUMER} -B ${BUILD} ${CONFIGURE} -DPROGRAMS=main
                        "-DCMAKE_CXX_FLAGS=${LIBRARY_FLAGS} ${FLAGS}"
                OUTPUT_QUIET COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${CMAKE_COMMAND} --build ${BUILD}
                OUTPUT_VARIABLE said ERROR_VARIABLE said RESULT_VARIABLE failed)

if(REFUSED OR NOT library STREQUAL program)
  if(NOT REFUSED)
    string(CONCAT REFUSED "manycontact was built with EIGEN_MAX_ALIGN_BYTES=${library_max_align} .*, "
                          "this file with ${program_max_align} .*: (build|compile)")
  endif()
  string(REGEX MATCHALL "error:[^\n]*" errors "${said}")
  list(LENGTH errors count)
  if(NOT failed OR NOT count EQUAL 1 OR NOT errors MATCHES "${REFUSED}")
    message(FATAL_ERROR "expected one error, '${REFUSED}', found ${count}:\n${said}")
  endif()
  message("refused: ${errors}")
  return()
endif()

if(failed)
  message(FATAL_ERROR "does not build, though Eigen is the same on both sides (${program}):\n${said}")
endif()
set(ENV{ASAN_OPTIONS} detect_leaks=1)
execute_process(COMMAND ${BUILD}/main ${SCENE}
                OUTPUT_VARIABLE printed ERROR_VARIABLE complained RESULT_VARIABLE status)
if(NOT status EQUAL 0 OR NOT printed MATCHES "${PRINTS}" OR NOT complained STREQUAL "")
  message(FATAL_ERROR "ended with ${status}\n${printed}\n${complained}")
endif()
message("runs, Eigen is the same on both sides: ${program}")
