# embedded.cpp puts into the program: the text of commands, the page's template and style, its scripts as one, and three.js, Debian's
# libjs-three. Without three.js everything is built all the same, and `view` reports that it is missing.
set(page_dir ${PROJECT_SOURCE_DIR}/src/program/view/page)
set(page_script ${PROJECT_BINARY_DIR}/view_page.js)
set(page_parts arrays camera shapes contacts plots page)
list(TRANSFORM page_parts REPLACE "(.+)" "${page_dir}/\\1.js")
add_custom_command(OUTPUT ${page_script} COMMAND ${CMAKE_COMMAND} -E cat ${page_parts} > ${page_script}
                   DEPENDS ${page_parts} VERBATIM)

find_file(MANYCONTACT_THREE_JS three.min.js PATHS /usr/share/javascript/three /usr/share/nodejs/three/build
          NO_DEFAULT_PATH DOC "three.js (UMD, minified) for the pages of `manycontact view`")
mark_as_advanced(MANYCONTACT_THREE_JS)
set(commands_text ${PROJECT_SOURCE_DIR}/src/program/command/commands.txt)
set(embedded ${commands_text} ${page_dir}/page.html ${page_dir}/page.css ${page_script})
set(embedded_definitions MANYCONTACT_COMMANDS="${commands_text}" MANYCONTACT_PAGE_HTML="${page_dir}/page.html" MANYCONTACT_PAGE_CSS="${page_dir}/page.css"
                         MANYCONTACT_PAGE_SCRIPT="${page_script}")
if(MANYCONTACT_THREE_JS)
  list(APPEND embedded ${MANYCONTACT_THREE_JS})
  list(APPEND embedded_definitions MANYCONTACT_THREE="${MANYCONTACT_THREE_JS}")
else()
  message(STATUS "three.js was not found (libjs-three): `manycontact view` will not work")
endif()
target_sources(manycontact_commands PRIVATE ${page_script})
set_source_files_properties(src/program/view/embedded.cpp PROPERTIES
  SKIP_UNITY_BUILD_INCLUSION ON OBJECT_DEPENDS "${embedded}" COMPILE_DEFINITIONS "${embedded_definitions}")
