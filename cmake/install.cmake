# SPDX-License-Identifier: Apache-2.0
# cmake --install: program with its studies, models, man page and completion; headers, libraries and the package config,
# so that find_package(truebearing) gives truebearing::truebearing, truebearing::training and truebearing::app, and
# pkg-config the first of them.
include(CMakePackageConfigHelpers)

# Until 1.0 a minor version may change the layout of anything.
set_target_properties(truebearing truebearing_training truebearing_app PROPERTIES
  VERSION ${PROJECT_VERSION} SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
set_target_properties(truebearing_training PROPERTIES EXPORT_NAME training)
set_target_properties(truebearing_app PROPERTIES EXPORT_NAME app)
# What is installed looks for libraries as it does in the build tree: for a path that CMake exchanges on the way it makes
# room by an empty element, which stands for the current folder.
set(installed truebearing_program)
if(BUILD_SHARED_LIBS)
  list(APPEND installed truebearing truebearing_training truebearing_app)
  set_target_properties(truebearing truebearing_training truebearing_app PROPERTIES INSTALL_RPATH $ORIGIN)
  file(RELATIVE_PATH libraries_from_program /${CMAKE_INSTALL_BINDIR} /${CMAKE_INSTALL_LIBDIR})
  set_target_properties(truebearing_program PROPERTIES INSTALL_RPATH "$ORIGIN;$ORIGIN/${libraries_from_program}")
endif()
set_target_properties(${installed} PROPERTIES BUILD_WITH_INSTALL_RPATH ON INSTALL_RPATH_USE_LINK_PATH ON)

install(TARGETS truebearing truebearing_training truebearing_app EXPORT truebearing_targets
        LIBRARY COMPONENT program NAMELINK_COMPONENT development ARCHIVE COMPONENT development)
install(TARGETS truebearing_program COMPONENT program)

# What comes with the program, which looks for it in share/truebearing above its own folder or, as built, beside itself
# (app/data_folder.cpp).
set(shared ${CMAKE_INSTALL_DATAROOTDIR})
install(DIRECTORY data models DESTINATION ${shared}/truebearing COMPONENT program)
install(FILES README.md CONTRIBUTING.md LICENSE DESTINATION ${shared}/doc/truebearing COMPONENT program)
install(DIRECTORY docs DESTINATION ${shared}/doc/truebearing COMPONENT program)
install(FILES LICENSE DESTINATION ${shared}/doc/truebearing RENAME copyright COMPONENT program)
install(FILES packaging/truebearing.1 DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT program)
install(FILES packaging/truebearing.bash DESTINATION ${shared}/bash-completion/completions RENAME truebearing
        COMPONENT program)
if(PROJECT_IS_TOP_LEVEL)
  file(MAKE_DIRECTORY ${CMAKE_BINARY_DIR}/share/truebearing)
  foreach(folder data models)
    file(CREATE_LINK ${PROJECT_SOURCE_DIR}/${folder} ${CMAKE_BINARY_DIR}/share/truebearing/${folder} SYMBOLIC)
  endforeach()
endif()

# Installed headers are included by the paths that the code itself uses: truebearing/core/..., training/..., app/....
set(headers ${CMAKE_INSTALL_INCLUDEDIR}/truebearing)
install(DIRECTORY src/truebearing/ DESTINATION ${headers} COMPONENT development FILES_MATCHING PATTERN *.hpp)
install(DIRECTORY training/ DESTINATION ${headers}/training COMPONENT development FILES_MATCHING PATTERN *.hpp)
install(FILES src/app/command_line.hpp DESTINATION ${headers}/app COMPONENT development)

set(package ${CMAKE_INSTALL_LIBDIR}/cmake/truebearing)
install(EXPORT truebearing_targets NAMESPACE truebearing:: FILE truebearing-targets.cmake DESTINATION ${package}
        COMPONENT development)
configure_package_config_file(cmake/truebearing-config.cmake.in truebearing-config.cmake
                              INSTALL_DESTINATION ${package} NO_SET_AND_CHECK_MACRO)
write_basic_package_version_file(truebearing-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/truebearing-config.cmake
              ${CMAKE_CURRENT_BINARY_DIR}/truebearing-config-version.cmake DESTINATION ${package} COMPONENT development)

# What the headers include, and with a static library what that stands on, as in truebearing-config.cmake.in.
set(pkgconfig_requires "eigen3 tomlplusplus nlohmann_json")
if(NOT BUILD_SHARED_LIBS)
  string(APPEND pkgconfig_requires " fmt tbb geographiclib hdf5")
endif()
file(RELATIVE_PATH prefix_from_pkgconfig /${CMAKE_INSTALL_LIBDIR}/pkgconfig /)
string(REGEX REPLACE "/$" "" prefix_from_pkgconfig ${prefix_from_pkgconfig})
configure_file(cmake/truebearing.pc.in truebearing.pc @ONLY)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/truebearing.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig
        COMPONENT development)
