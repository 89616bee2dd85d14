# Every page has a title, and its links and pictures lead to existing files.
#   PROJECT: the top folder
file(GLOB pages ${PROJECT}/*.md ${PROJECT}/src/doc/*.md ${PROJECT}/src/doc/*/*.md ${PROJECT}/models/*.md ${PROJECT}/sparse/*.md
                ${PROJECT}/bench/*/README.md ${PROJECT}/tests/*/README.md)
set(count 0)
foreach(page IN LISTS pages)
  file(READ ${page} text)
  if(NOT text MATCHES "^# ")
    message(SEND_ERROR "${page} does not begin with a title")
  endif()
  string(REGEX REPLACE "```[^`]*```" "" text "${text}")  # programs
  string(REPLACE "](" "@(" text "${text}")
  string(REGEX REPLACE "[][;]" " " text "${text}")  # CMake's lists would break at these
  string(REGEX MATCHALL "@\\([^()# \n]+" links "${text}")
  get_filename_component(folder ${page} DIRECTORY)
  foreach(link IN LISTS links)
    string(REGEX REPLACE "^@\\(" "" link "${link}")
    if(NOT link MATCHES "^[a-z]+:")
      math(EXPR count "${count} + 1")
      if(NOT EXISTS ${folder}/${link})
        message(SEND_ERROR "${page} leads to ${link}, which is not there")
      endif()
    endif()
  endforeach()
endforeach()
if(count LESS 30)
  message(SEND_ERROR "only ${count} links found: has the way they are written changed?")
endif()
