# Configures manycontact alone, by add_subdirectory and by FetchContent, with GENERATOR, and builds its libraries with
# empty objects: rules that a generator misses are found in seconds.
set(modules kernels sparse spatial model algorithm contact rank kkt dynamics io analysis simulation lq action control task)
list(TRANSFORM modules PREPEND manycontact_)
list(REMOVE_ITEM modules manycontact_spatial)  # headers alone
cmake_policy(VERSION 3.22)
foreach(way IN ITEMS alone add_subdirectory FetchContent)
  set(build ${BUILD}/${way})
  set(source ${BUILD}/source_of_${way})
  file(REMOVE_RECURSE ${build} ${source})
  set(options)
  if(way STREQUAL "FetchContent")
    set(options -DFETCHCONTENT_SOURCE_DIR_MANYCONTACT=${PROJECT})
  endif()
  if(way STREQUAL "alone")
    set(source ${PROJECT})
  else()  # the project of the page, with these sources
    file(COPY ${PROJECT}/tests/link/parent/${way}/ DESTINATION ${source})
    configure_file(${PROJECT}/tests/link/consumer/main.cpp ${source}/my_program.cpp COPYONLY)
    file(CREATE_LINK ${PROJECT} ${source}/manycontact SYMBOLIC)
  endif()
  execute_process(COMMAND ${CMAKE_COMMAND} -S ${source} -B ${build} -G ${GENERATOR} -DCMAKE_CXX_COMPILER=${CXX}
                          -DCMAKE_CXX_COMPILER_LAUNCHER=${PROJECT}/tests/link/empty_object.sh ${options}
                          -DMANYCONTACT_TESTS=OFF -DMANYCONTACT_BENCH=OFF
                          -DMANYCONTACT_CHART=OFF -DCMAKE_BUILD_TYPE=Release
                  OUTPUT_QUIET COMMAND_ERROR_IS_FATAL ANY)
  execute_process(COMMAND ${CMAKE_COMMAND} --build ${build} -j 2 --target ${modules}
                  OUTPUT_QUIET COMMAND_ERROR_IS_FATAL ANY)
  file(GLOB_RECURSE built ${build}/libmanycontact_*.a)
  list(LENGTH built count)
  list(LENGTH modules expected)
  if(NOT count EQUAL expected)
    message(FATAL_ERROR "${GENERATOR}, ${way}: ${count} libraries were built, expected ${expected}")
  endif()
  message("${GENERATOR}, ${way}: ${count} libraries")
endforeach()
