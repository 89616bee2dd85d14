# eigen_memory(FLAGS NAME) sets NAME to how Eigen aligns and allocates when compiled by CXX with FLAGS,
# "max align, static align, 1 for malloc", and NAME_max_align.
function(eigen_memory flags name)
  separate_arguments(flags UNIX_COMMAND "${flags}")
  execute_process(COMMAND ${CXX} ${flags} -I${EIGEN} -E -P -x c++ ${CMAKE_CURRENT_FUNCTION_LIST_DIR}/eigen_memory.txt
                  OUTPUT_VARIABLE text COMMAND_ERROR_IS_FATAL ANY)
  if(NOT text MATCHES "eigen_memory +([0-9]+) +([0-9]+) +([01])")
    message(FATAL_ERROR "Eigen could not be preprocessed with ${flags}")
  endif()
  set(${name} "${CMAKE_MATCH_1}, ${CMAKE_MATCH_2}, ${CMAKE_MATCH_3}" PARENT_SCOPE)
  set(${name}_max_align ${CMAKE_MATCH_1} PARENT_SCOPE)
endfunction()
