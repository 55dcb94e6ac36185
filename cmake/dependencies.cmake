# SPDX-License-Identifier: Apache-2.0
# What truebearing stands on. All of it is in Debian 12; the installed package config finds the same again.
find_package(Eigen3 3.4 REQUIRED NO_MODULE)
find_package(fmt 9 REQUIRED)
find_package(nlohmann_json 3.11 REQUIRED)
find_package(tomlplusplus 3.3 REQUIRED)
find_package(TBB REQUIRED)
find_package(CLI11 2.1 REQUIRED)
find_package(NLopt REQUIRED)
find_package(Boost 1.74 REQUIRED)
find_package(PkgConfig REQUIRED)
pkg_check_modules(GEOGRAPHICLIB REQUIRED IMPORTED_TARGET geographiclib)  # Debian has no CMake package of it
pkg_check_modules(HDF5 REQUIRED IMPORTED_TARGET hdf5>=1.10)  # CMake's own module of it wants a C compiler
find_path(TRUEBEARING_RANDOM123 Random123/philox.h REQUIRED)  # headers only, without a CMake package
