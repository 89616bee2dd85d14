# The parts of SuiteSparse that module sparse links, as the target manycontact::suitesparse. Used by the build and by the
# installed package alike; SuiteSparse before 7 has no CMake package, so headers and libraries are looked up.
if(TARGET manycontact::suitesparse)
  return()
endif()

find_path(MANYCONTACT_SUITESPARSE_INCLUDE_DIR cholmod.h PATH_SUFFIXES suitesparse REQUIRED)
mark_as_advanced(MANYCONTACT_SUITESPARSE_INCLUDE_DIR)
add_library(manycontact::suitesparse INTERFACE IMPORTED GLOBAL)
target_include_directories(manycontact::suitesparse INTERFACE ${MANYCONTACT_SUITESPARSE_INCLUDE_DIR})

foreach(part IN ITEMS cholmod ldl camd amd suitesparseconfig)
  find_library(MANYCONTACT_${part}_LIBRARY ${part} REQUIRED)
  mark_as_advanced(MANYCONTACT_${part}_LIBRARY)
  target_link_libraries(manycontact::suitesparse INTERFACE ${MANYCONTACT_${part}_LIBRARY})
endforeach()
