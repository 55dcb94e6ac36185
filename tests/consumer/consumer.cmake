# SPDX-License-Identifier: Apache-2.0
# Installs the built tree to a prefix of its own, builds project/ against it with other compiler flags, and wants the
# output that the same program gives in the build tree.
function(run)
  execute_process(COMMAND ${ARGN} OUTPUT_QUIET COMMAND_ERROR_IS_FATAL ANY)
endfunction()

set(work ${BUILD_DIR}/consumer)
set(study ${SOURCE_DIR}/data/studies/radar_1d_family.toml)
set(measurements ${SOURCE_DIR}/examples/embed/measurements.txt)
file(REMOVE_RECURSE ${work})

run(${CMAKE_COMMAND} --install ${BUILD_DIR} --prefix ${work}/prefix)
run(${CMAKE_COMMAND} -DREADELF=${READELF} "-DFOLDERS=${BUILD_DIR};${work}/prefix/bin;${work}/prefix/lib"
    -P ${CMAKE_CURRENT_LIST_DIR}/linked_programs.cmake)
run(${work}/prefix/bin/truebearing check radar_1d_family)
foreach(file share/doc/truebearing/README.md share/doc/truebearing/LICENSE share/man/man1/truebearing.1
             share/bash-completion/completions/truebearing)
  if(NOT EXISTS ${work}/prefix/${file})
    message(FATAL_ERROR "${file} is not installed")
  endif()
endforeach()
# -march=native: a program that may use wider vectors than the library must still agree with it on every layout.
run(${CMAKE_COMMAND} -G ${GENERATOR} -S ${CMAKE_CURRENT_LIST_DIR}/project -B ${work}/build
    -DCMAKE_PREFIX_PATH=${work}/prefix -DCMAKE_BUILD_TYPE=${BUILD_TYPE} -DCMAKE_CXX_COMPILER=${COMPILER}
    -DCMAKE_CXX_COMPILER_LAUNCHER=${LAUNCHER} -DCMAKE_CXX_FLAGS=-march=native -DEXAMPLES=${SOURCE_DIR}/examples)
run(${CMAKE_COMMAND} --build ${work}/build)
run(${work}/build/own_tracker check ${SOURCE_DIR}/examples/own_tracker/own_tracker.toml)

# By pkg-config; without the flags that it tells, the layout of records would be another.
set(ENV{PKG_CONFIG_PATH} ${work}/prefix/lib/pkgconfig:${work}/prefix/lib/x86_64-linux-gnu/pkgconfig)
execute_process(COMMAND pkg-config --cflags truebearing OUTPUT_VARIABLE flags COMMAND_ERROR_IS_FATAL ANY)
separate_arguments(flags UNIX_COMMAND ${flags})
file(WRITE ${work}/header.cpp "#include <truebearing/core/bounded.hpp>\nint main() {}\n")
set(compile ${COMPILER} -std=c++20 -march=native -fsyntax-only ${work}/header.cpp)
run(${compile} ${flags})
list(FILTER flags EXCLUDE REGEX EIGEN_MAX_ALIGN_BYTES)
execute_process(COMMAND ${compile} -mavx ${flags} RESULT_VARIABLE refused ERROR_VARIABLE error)
if(NOT refused OR NOT error MATCHES "compile with -DEIGEN_MAX_ALIGN_BYTES=16")
  message(FATAL_ERROR "Another layout is not refused:\n${error}")
endif()

execute_process(COMMAND ${work}/build/embed ${study} INPUT_FILE ${measurements} OUTPUT_VARIABLE installed
                COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${EMBED} ${study} INPUT_FILE ${measurements} OUTPUT_VARIABLE expected
                COMMAND_ERROR_IS_FATAL ANY)
if(NOT installed MATCHES "\n20 s: [0-9.]+ \\+- [0-9.]+ m\n" OR NOT installed STREQUAL expected)
  message(FATAL_ERROR "From the installed package:\n${installed}\nFrom the build tree:\n${expected}")
endif()
