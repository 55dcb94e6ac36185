# cmake --install: headers, libraries, program and the package config, so that find_package(truebearing) gives
# truebearing::truebearing, truebearing::training and truebearing::app.
include(CMakePackageConfigHelpers)

# Until 1.0 a minor version may change the layout of anything.
set_target_properties(truebearing truebearing_training truebearing_app PROPERTIES
  VERSION ${PROJECT_VERSION} SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR} INSTALL_RPATH $ORIGIN)
set_target_properties(truebearing_training PROPERTIES EXPORT_NAME training)
set_target_properties(truebearing_app PROPERTIES EXPORT_NAME app)
file(RELATIVE_PATH libraries_from_program /${CMAKE_INSTALL_BINDIR} /${CMAKE_INSTALL_LIBDIR})
set_target_properties(truebearing_program PROPERTIES INSTALL_RPATH $ORIGIN/${libraries_from_program})

install(TARGETS truebearing truebearing_training truebearing_app EXPORT truebearing_targets)
install(TARGETS truebearing_program)

# Installed headers are included by the paths that the code itself uses: truebearing/core/..., training/..., app/....
set(headers ${CMAKE_INSTALL_INCLUDEDIR}/truebearing)
install(DIRECTORY src/truebearing/ DESTINATION ${headers} FILES_MATCHING PATTERN *.hpp)
install(DIRECTORY training/ DESTINATION ${headers}/training FILES_MATCHING PATTERN *.hpp)
install(FILES src/app/command_line.hpp DESTINATION ${headers}/app)

set(package ${CMAKE_INSTALL_LIBDIR}/cmake/truebearing)
install(EXPORT truebearing_targets NAMESPACE truebearing:: FILE truebearing-targets.cmake DESTINATION ${package})
configure_package_config_file(cmake/truebearing-config.cmake.in truebearing-config.cmake
                              INSTALL_DESTINATION ${package} NO_SET_AND_CHECK_MACRO)
write_basic_package_version_file(truebearing-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/truebearing-config.cmake
              ${CMAKE_CURRENT_BINARY_DIR}/truebearing-config-version.cmake DESTINATION ${package})
