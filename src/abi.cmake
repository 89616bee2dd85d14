# Writes manycontact/abi.hpp, which refuses programs that do not agree with the library on alignment and layouts: what
# Eigen and the standard library make of the flags in use, found by preprocessing them.
set(abi_probe ${PROJECT_BINARY_DIR}/abi_probe.txt)
file(WRITE ${abi_probe} [[
#include <Eigen/Core>
eigen_world=EIGEN_WORLD_VERSION;
eigen_major=EIGEN_MAJOR_VERSION;
max_align=EIGEN_MAX_ALIGN_BYTES;
static_align=EIGEN_MAX_STATIC_ALIGN_BYTES;
#if EIGEN_DEFAULT_ALIGN_BYTES == 0 || EIGEN_MALLOC_ALREADY_ALIGNED
from_malloc=1;
#else
from_malloc=0;
#endif
#ifdef _GLIBCXX_DEBUG
debug_containers=1;
#else
debug_containers=0;
#endif
#if !defined _GLIBCXX_USE_CXX11_ABI || _GLIBCXX_USE_CXX11_ABI
new_strings=1;
#else
new_strings=0;
#endif
]])

string(TOUPPER "${CMAKE_BUILD_TYPE}" build_type)
separate_arguments(abi_flags UNIX_COMMAND "${CMAKE_CXX_FLAGS} ${CMAKE_CXX_FLAGS_${build_type}}")
get_directory_property(directory_options COMPILE_OPTIONS)
get_directory_property(directory_definitions COMPILE_DEFINITIONS)
list(TRANSFORM directory_definitions PREPEND -D)
get_target_property(eigen_include_dirs Eigen3::Eigen INTERFACE_INCLUDE_DIRECTORIES)
list(TRANSFORM eigen_include_dirs PREPEND -I)
execute_process(COMMAND ${CMAKE_CXX_COMPILER} ${abi_flags} ${directory_options} ${directory_definitions}
                        ${eigen_include_dirs} -E -P -x c++ ${abi_probe}
                OUTPUT_VARIABLE preprocessed ERROR_VARIABLE errors RESULT_VARIABLE failed)
if(failed)
  message(FATAL_ERROR "Eigen could not be preprocessed with the flags in use:\n${errors}")
endif()
foreach(name IN ITEMS eigen_world eigen_major max_align static_align from_malloc debug_containers new_strings)
  if(NOT preprocessed MATCHES "${name} *= *([0-9]+) *;")
    message(FATAL_ERROR "the flags in use make no number of ${name}: do they define a macro of Eigen's?")
  endif()
  set(abi_${name} ${CMAKE_MATCH_1})
endforeach()
configure_file(src/abi.hpp.in ${PROJECT_BINARY_DIR}/include/manycontact/abi.hpp @ONLY)
