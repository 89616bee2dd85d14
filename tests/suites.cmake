# Writes FILE, which names ctest a test GROUP/SUITE for each suite of the test program PROGRAM. A suite is one process:
# starting one takes as long as most tests do.
execute_process(COMMAND ${PROGRAM} --gtest_list_tests OUTPUT_VARIABLE lines COMMAND_ERROR_IS_FATAL ANY)
string(REGEX MATCHALL "\n[^ \n][^ \n]*\\." suites "\n${lines}")
cmake_policy(SET CMP0057 NEW)  # IN_LIST
# These broad sweeps, which other suites cover with fewer cases, run in `./run test --all`.
set(nightly derivatives/Large/DirectionsOf derivatives/Seeds/RandomDifferences derivatives/Seeds/AppliedForcesOf
            stability/Far task/ControlAttack task/RandomJoined task/Robots/RingOfCopies)
set(text)
foreach(suite IN LISTS suites)
  string(REGEX REPLACE "^\n(.*)\\.$" "\\1" suite "${suite}")
  # BLAS threads would fight with ctest's jobs, and their sums depend on the number of cores. A suite is skipped where each
  # of its tests is; ctest's log lists other skipped tests.
  string(APPEND text "add_test([[${GROUP}/${suite}]] [[${PROGRAM}]] [[--gtest_filter=${suite}.*]])\n"
                     "set_tests_properties([[${GROUP}/${suite}]] PROPERTIES TIMEOUT 1800 ENVIRONMENT OPENBLAS_NUM_THREADS=1\n"
                     "  SKIP_REGULAR_EXPRESSION [[PASSED  \\] 0 tests\\.\n(\\[  SKIPPED \\] [^\n]*\n)+$]])\n")
  if("${GROUP}/${suite}" IN_LIST nightly)
    string(APPEND text "set_tests_properties([[${GROUP}/${suite}]] PROPERTIES LABELS nightly)\n")
  endif()
endforeach()
file(WRITE ${FILE} "${text}")
