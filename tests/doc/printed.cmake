# What the README says that its two commands print, they print, line by line; and the examples of the pages of files load.
#   PROGRAM: manycontact;  PROJECT: the top folder;  BUILD: a folder
file(READ ${PROJECT}/README.md page)
string(REGEX MATCH "## Two commands.*## Ten lines" page "${page}")
set(printed)
foreach(arguments IN ITEMS "solve models/two_humanoids_carry_beam.xml" "inspect models/feet_on_corners.xml")
  separate_arguments(arguments)
  execute_process(COMMAND ${PROGRAM} ${arguments} WORKING_DIRECTORY ${PROJECT}
                  OUTPUT_VARIABLE said COMMAND_ERROR_IS_FATAL ANY)
  string(APPEND printed "${said}")
endforeach()

string(REGEX REPLACE "[][;]" "?" page "${page}")  # CMake's lists would trip over these
string(REGEX REPLACE "[][;]" "?" printed "${printed}")
string(REGEX MATCHALL "\n    [^\n]+" lines "${page}")
list(FILTER lines EXCLUDE REGEX "^\n    (\\./run|build/)")
list(LENGTH lines count)
if(count LESS 10)
  message(SEND_ERROR "only ${count} lines of output found in the README")
endif()
foreach(line IN LISTS lines)
  string(REGEX REPLACE "^\n    " "" line "${line}")
  string(FIND "\n${printed}" "${line}\n" at)
  if(at EQUAL -1)
    message(SEND_ERROR "not printed: ${line}")
  endif()
endforeach()

# The example of a page of files: beside the models, which it names.
function(write_example page file)
  file(READ ${PROJECT}/src/doc/${page} text)
  if(NOT text MATCHES "```xml\n([^`]*)```")
    message(FATAL_ERROR "${page} shows no file")
  endif()
  file(WRITE ${BUILD}/models/${file} "${CMAKE_MATCH_1}")
endfunction()
file(COPY ${PROJECT}/models DESTINATION ${BUILD})
write_example(scene_file.md example.xml)
write_example(task_file.md tasks/example.xml)
execute_process(COMMAND ${PROGRAM} solve ${BUILD}/models/example.xml OUTPUT_QUIET COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${PROGRAM} optimize ${BUILD}/models/tasks/example.xml --out ${BUILD}/example.csv
                OUTPUT_QUIET ERROR_QUIET COMMAND_ERROR_IS_FATAL ANY)
