# Doxygen gives no warning on pages and links, and every function and class of FLOORS is documented.
#   DOXYGEN, PROJECT: the program, the top folder;  BUILD: where to put what it makes;  FLOORS: headers or their folders
function(complaints said)  # further lines of the Doxyfile
  string(JOIN "\n" more ${ARGN})
  execute_process(COMMAND python3 ${PROJECT}/src/doc/site.py ${BUILD} OUTPUT_VARIABLE doxyfile COMMAND_ERROR_IS_FATAL ANY)
  file(WRITE ${BUILD}/Doxyfile "${doxyfile}\n${more}\n")
  execute_process(COMMAND ${DOXYGEN} ${BUILD}/Doxyfile WORKING_DIRECTORY ${PROJECT}
                  OUTPUT_QUIET ERROR_VARIABLE warnings RESULT_VARIABLE failed)
  string(REGEX REPLACE "warning: No output formats[^\n]*\n" "" warnings "${warnings}")
  if(failed AND NOT warnings)
    message(FATAL_ERROR "doxygen ended with ${failed}")
  endif()
  set(${said} "${warnings}" PARENT_SCOPE)
endfunction()

file(REMOVE_RECURSE ${BUILD}/html)  # pages of an earlier run

# Only the first lines of the page of 908 cases: its table takes twice as long as all the rest.
complaints(said "SEARCHENGINE = NO" "FILTER_PATTERNS = */stability/README.md=\"head -40\" *.hpp=\"perl src/doc/filter.pl\" \\
                                    *.md=\"python3 src/doc/site.py --filter\"")
if(said)
  message(FATAL_ERROR "${said}")
endif()

# The navigation leads to existing pages.
file(STRINGS ${BUILD}/layout.xml tabs REGEX "url=")
list(LENGTH tabs count)
if(count LESS 40)
  message(SEND_ERROR "only ${count} pages in the navigation")
endif()
foreach(tab IN LISTS tabs)
  string(REGEX REPLACE ".*url=\"([^\"]*)\".*" "\\1" url "${tab}")
  if(NOT EXISTS ${BUILD}/html/${url})
    message(SEND_ERROR "the navigation leads to ${url}, which doxygen did not make")
  endif()
endforeach()

# The links of every page lead to existing pages.
execute_process(COMMAND python3 ${CMAKE_CURRENT_LIST_DIR}/site_links.py ${BUILD}/html OUTPUT_VARIABLE said RESULT_VARIABLE failed)
if(failed)
  message(SEND_ERROR "${said}")
endif()

list(TRANSFORM FLOORS PREPEND include/manycontact/)
string(JOIN " " floors ${FLOORS})
complaints(said "INPUT = ${floors}" "GENERATE_HTML = NO" "EXTRACT_ALL = NO" "WARN_IF_UNDOCUMENTED = YES" "WARN_AS_ERROR = NO")
string(REGEX MATCHALL "[^\n]*(Compound|\\((function|friend)\\))[^\n]* is not documented" undocumented "${said}")
list(FILTER undocumented EXCLUDE REGEX "operator(==|<=>|=)\\(| override ")
if(undocumented)
  string(JOIN "\n" lines ${undocumented})
  message(FATAL_ERROR "${lines}")
endif()
