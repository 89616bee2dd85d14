# The programs in Python that pages show run.
#   PYTHON, PROJECT: interpreter, top folder;  BUILD: a folder
foreach(page IN ITEMS README.md src/doc/tutorial.md src/doc/python.md)
  file(READ ${PROJECT}/${page} text)
  if(NOT text MATCHES "```python\n([^`]*)```")
    message(FATAL_ERROR "${page} shows no program in Python")
  endif()
  file(WRITE ${BUILD}/page.py "${CMAKE_MATCH_1}")
  execute_process(COMMAND ${PYTHON} ${BUILD}/page.py WORKING_DIRECTORY ${PROJECT} COMMAND_ERROR_IS_FATAL ANY)
endforeach()
