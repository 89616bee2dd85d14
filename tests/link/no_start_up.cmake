# Kernels of a level of instructions are called where the processor has these. Nothing of theirs may run before, as
# variables that are made when the program starts would.
execute_process(COMMAND ${OBJDUMP} -h ${OBJECT} OUTPUT_VARIABLE sections COMMAND_ERROR_IS_FATAL ANY)
if(NOT sections MATCHES "\\.text")
  message(FATAL_ERROR "no sections are told of ${OBJECT}:\n${sections}")
endif()
if(sections MATCHES "\\.(init_array|ctors)")
  message(FATAL_ERROR "${OBJECT} has code that runs when the program starts, expected none")
endif()
