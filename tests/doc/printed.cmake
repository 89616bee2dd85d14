# What the README says that its two commands print, they print, line by line.
#   PROGRAM: manycontact;  PROJECT: the top folder
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
