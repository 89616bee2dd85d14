# What is installed, and Debian's packages of it: components runtime (the shared library), dev, program,
# python.
set(CMAKE_INSTALL_DEFAULT_COMPONENT_NAME dev)
set(CMAKE_SKIP_INSTALL_ALL_DEPENDENCY ON)  # packages need not wait for tests
configure_file(src/package/version.hpp.in ${PROJECT_BINARY_DIR}/include/manycontact/version.hpp @ONLY)

# ---- the library: static, a target per module (manycontact::manycontact), and shared as one (manycontact::shared) ------
get_property(modules GLOBAL PROPERTY manycontact_modules)
list(PREPEND modules manycontact_kernels)
install(TARGETS ${modules} manycontact EXPORT manycontactTargets COMPONENT dev)
if(MANYCONTACT_SHARED)
  file(GENERATE OUTPUT ${PROJECT_BINARY_DIR}/shared.cpp CONTENT "// The library's code comes from its modules.\n")
  add_library(manycontact_shared SHARED ${PROJECT_BINARY_DIR}/shared.cpp)
  add_library(manycontact::shared ALIAS manycontact_shared)
  set_target_properties(manycontact_shared PROPERTIES OUTPUT_NAME manycontact EXPORT_NAME shared UNITY_BUILD OFF
    VERSION ${PROJECT_VERSION} SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR}
    LINK_DEPENDS ${PROJECT_SOURCE_DIR}/src/package/exports.map)
  set(exports ${PROJECT_SOURCE_DIR}/src/package/exports.map)
  target_link_libraries(manycontact_shared PRIVATE -Wl,--whole-archive ${modules} -Wl,--no-whole-archive
                                           INTERFACE Eigen3::Eigen)
  target_link_options(manycontact_shared PRIVATE -Wl,--version-script=${exports} -Wl,--no-undefined)
  target_include_directories(manycontact_shared INTERFACE $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  target_compile_features(manycontact_shared INTERFACE cxx_std_20)
  install(TARGETS manycontact_shared EXPORT manycontactTargets
          LIBRARY COMPONENT runtime NAMELINK_COMPONENT dev)

  file(RELATIVE_PATH pc_prefix /${CMAKE_INSTALL_LIBDIR}/pkgconfig /)
  string(REGEX REPLACE "/$" "" pc_prefix ${pc_prefix})
  configure_file(src/package/manycontact.pc.in manycontact.pc @ONLY)
  install(FILES ${PROJECT_BINARY_DIR}/manycontact.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
endif()

# find_package(manycontact)
include(CMakePackageConfigHelpers)
set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/manycontact)
configure_package_config_file(src/package/manycontactConfig.cmake.in manycontactConfig.cmake
                              INSTALL_DESTINATION ${package_dir}
                              PATH_VARS CMAKE_INSTALL_INCLUDEDIR)
write_basic_package_version_file(manycontactConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(EXPORT manycontactTargets NAMESPACE manycontact:: DESTINATION ${package_dir})
install(FILES ${PROJECT_BINARY_DIR}/manycontactConfig.cmake ${PROJECT_BINARY_DIR}/manycontactConfigVersion.cmake
              src/suitesparse.cmake DESTINATION ${package_dir})
set(without_optimal_control)
if(NOT MANYCONTACT_OPTIMAL_CONTROL)
  set(without_optimal_control REGEX "manycontact/(detail/)?(action|control|task|crocoddyl)(\\.hpp)?$" EXCLUDE)
endif()
install(DIRECTORY include/ ${PROJECT_BINARY_DIR}/include/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}
        FILES_MATCHING PATTERN "*.hpp" ${without_optimal_control})

# Headers without a promise, which the project src/optimal_control includes. The closure of their includes is here.
set(detail_dir ${CMAKE_INSTALL_INCLUDEDIR}/manycontact/detail)
foreach(header IN ITEMS sparse/dense_kernels sparse/largest sparse/ldl sparse/ldl_schedule sparse/ordering
                        sparse/panel_kernels sparse/refine sparse/tolerances sparse/union_find sparse/upper_csc
                        model/applied_forces model/expect_state algorithm/applied_forces contact/turning_rows
                        rank/least_norm dynamics/follow_kinematics dynamics/keep_dependent dynamics/parallel
                        dynamics/static_torque analysis/names analysis/text simulation/free_joints
                        simulation/momentum_derivatives simulation/resisting_joints)
  file(GLOB file src/core/private/manycontact/${header}.hpp src/tools/private/manycontact/${header}.hpp
                 sparse/private/manycontact/${header}.hpp)
  get_filename_component(folder ${header} DIRECTORY)
  install(FILES ${file} DESTINATION ${detail_dir}/manycontact/${folder})
endforeach()
if(NOT PROJECT_IS_TOP_LEVEL)
  return()
endif()

# ---- the programs ---------------------------------------------------------------------------------------------------
foreach(program IN ITEMS manycontact_cli manycontact_optimize manycontact_chart manycontact_mesh manycontact_mpi)
  if(TARGET ${program})
    install(TARGETS ${program} COMPONENT program)
  endif()
endforeach()
install(DIRECTORY models DESTINATION ${CMAKE_INSTALL_DATADIR}/manycontact COMPONENT program)
install(DIRECTORY src/program/charts DESTINATION ${CMAKE_INSTALL_DATADIR}/manycontact COMPONENT program
        FILES_MATCHING PATTERN "*.py")
install(FILES src/package/manycontact.bash COMPONENT program RENAME manycontact
        DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions)
# The page is what the program says of itself.
install(CODE "execute_process(COMMAND sh \"${PROJECT_SOURCE_DIR}/src/package/man.sh\" \"$<TARGET_FILE:manycontact_cli>\"
                              OUTPUT_FILE \"${PROJECT_BINARY_DIR}/manycontact.1\" COMMAND_ERROR_IS_FATAL ANY)"
        COMPONENT program)
install(FILES ${PROJECT_BINARY_DIR}/manycontact.1 DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT program)

# ---- Debian's packages: cpack -G DEB ----------------------------------------------------------------------------------
set(runtime_package libmanycontact${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
set(packages ${runtime_package} libmanycontact-dev manycontact)
set(CPACK_COMPONENTS_ALL runtime dev program)
if(TARGET manycontact_python)
  list(APPEND packages python3-manycontact)
  list(APPEND CPACK_COMPONENTS_ALL python)
endif()
foreach(package IN LISTS packages)
  if(package STREQUAL "python3-manycontact")
    set(component python)
  elseif(package STREQUAL "libmanycontact-dev")
    set(component dev)
  elseif(package STREQUAL "manycontact")
    set(component program)
  else()
    set(component runtime)
  endif()
  install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/${package} RENAME copyright COMPONENT ${component})
  install(FILES CHANGELOG.md DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/${package} COMPONENT ${component})
  string(TOUPPER ${component} name)
  set(CPACK_DEBIAN_${name}_PACKAGE_NAME ${package})
endforeach()
set(CPACK_GENERATOR DEB)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_PACKAGE_CONTACT "The manycontact authors <manycontact@example.org>")
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_COMPRESSION_TYPE gzip)
set(CPACK_STRIP_FILES ON)
set(CPACK_OUTPUT_FILE_PREFIX packages)
set(CPACK_DEBIAN_RUNTIME_PACKAGE_SECTION libs)
set(CPACK_DEBIAN_RUNTIME_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_DEV_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEV_PACKAGE_DEPENDS "${runtime_package} (= ${PROJECT_VERSION}), libeigen3-dev (>= 3.4), \
libsuitesparse-dev, liburdfdom-dev, libtinyxml2-dev")
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_RECOMMENDS python3-matplotlib)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS "${manycontact_python_needs}, python3-numpy")
set(CPACK_DEBIAN_PYTHON_PACKAGE_RECOMMENDS python3-scipy)
set(CPACK_DEBIAN_PYTHON_PACKAGE_CONTROL_EXTRA ${PROJECT_SOURCE_DIR}/src/package/prerm)
set(CPACK_COMPONENT_PYTHON_DESCRIPTION "${PROJECT_DESCRIPTION}: the Python package")
set(CPACK_COMPONENT_RUNTIME_DESCRIPTION "${PROJECT_DESCRIPTION}: the shared library")
set(CPACK_COMPONENT_DEV_DESCRIPTION "${PROJECT_DESCRIPTION}: headers, static libraries, CMake and pkg-config files")
set(CPACK_COMPONENT_PROGRAM_DESCRIPTION "${PROJECT_DESCRIPTION}: the program, with scenes and tasks to try")
include(CPack)
