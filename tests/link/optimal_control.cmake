# Installs the core without optimal control, then configures src/optimal_control as a project of its own on it: each of
# its sources finds the headers that it includes among the core's installed ones.
set(prefix ${BUILD}/prefix)
file(REMOVE_RECURSE ${BUILD})
set(options -G Ninja -DCMAKE_CXX_COMPILER=${CXX} -DCMAKE_BUILD_TYPE=Release)
execute_process(COMMAND ${CMAKE_COMMAND} -S ${PROJECT} -B ${BUILD}/core ${options} -DMANYCONTACT_OPTIMAL_CONTROL=OFF
                        -DCMAKE_CXX_COMPILER_LAUNCHER=${PROJECT}/tests/link/empty_object.sh -DMANYCONTACT_SHARED=OFF
                        -DMANYCONTACT_TESTS=OFF -DMANYCONTACT_BENCH=OFF -DMANYCONTACT_CHART=OFF
                OUTPUT_QUIET COMMAND_ERROR_IS_FATAL ANY)
set(modules kernels sparse model algorithm contact rank kkt dynamics io analysis simulation)
list(TRANSFORM modules PREPEND manycontact_)
execute_process(COMMAND ${CMAKE_COMMAND} --build ${BUILD}/core -j 2 --target ${modules}
                OUTPUT_QUIET COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${CMAKE_COMMAND} --install ${BUILD}/core --prefix ${prefix} --component dev
                OUTPUT_QUIET COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${CMAKE_COMMAND} -S ${PROJECT}/src/optimal_control -B ${BUILD}/optimal_control ${options}
                        -DCMAKE_PREFIX_PATH=${prefix} -DCMAKE_CXX_COMPILER_LAUNCHER=${LAUNCHER}
                OUTPUT_QUIET COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${CMAKE_COMMAND} --build ${BUILD}/optimal_control -j 2 OUTPUT_QUIET COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${CMAKE_COMMAND} --install ${BUILD}/optimal_control --prefix ${prefix}
                OUTPUT_QUIET COMMAND_ERROR_IS_FATAL ANY)
foreach(file IN ITEMS lib/cmake/manycontact_optimal_control/manycontact_optimal_controlConfig.cmake
                      include/manycontact/action.hpp include/manycontact/crocoddyl/names.hpp)
  if(NOT EXISTS ${prefix}/${file})
    message(FATAL_ERROR "${file} was not installed")
  endif()
endforeach()
message("optimal control was built on the installed core")
