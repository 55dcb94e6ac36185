# SPDX-License-Identifier: Apache-2.0
# truebearing_options(TARGET): the warnings, optimisation and sanitizers that every target of the house shares.
function(truebearing_options target)
  target_compile_features(${target} PUBLIC cxx_std_20)
  target_compile_options(${target} PRIVATE -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wsign-conversion
                                           $<$<BOOL:${TRUEBEARING_WARNINGS_AS_ERRORS}>:-Werror>)
  # The same bits on every build of one machine: no contraction into fused multiply-adds, whatever -march says.
  target_compile_options(${target} PRIVATE -ffp-contract=off -fno-math-errno)
  truebearing_harden(${target})
  # Rooms are long translation units: GCC spends some of its time (7 % of the longest file's of `study`) on collecting
  # garbage, which it need not where the machine has memory for each of its processors.
  if(TRUEBEARING_BUILD_BY_ROOM AND CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    cmake_host_system_information(RESULT memory_MiB QUERY TOTAL_PHYSICAL_MEMORY)
    cmake_host_system_information(RESULT processors QUERY NUMBER_OF_LOGICAL_CORES)
    math(EXPR each_MiB "${memory_MiB} / ${processors}")
    if(each_MiB GREATER_EQUAL 4096)
      target_compile_options(${target} PRIVATE --param=ggc-min-heapsize=2000000)  # KiB
    endif()
  endif()
  if(TRUEBEARING_SANITIZE)
    # Left out are the four checks of every pointer, which double the time to compile Eigen; the address sanitizer
    # sees the accesses themselves.
    target_compile_options(${target} PRIVATE -fsanitize=${TRUEBEARING_SANITIZE}
                           -fno-sanitize=null,alignment,object-size,vptr -fno-sanitize-recover=all
                                             -fno-omit-frame-pointer)
    target_link_options(${target} PUBLIC -fsanitize=${TRUEBEARING_SANITIZE})
    target_compile_definitions(${target} PRIVATE TRUEBEARING_PRODUCTS_AS_LOOPS  # filter/product.hpp
                                                 _GLIBCXX_ASSERTIONS)
  endif()
endfunction()

# truebearing_harden(TARGET): what makes a slip that a hostile file finds end the program instead of serving the file:
# guarded stacks, checked copies, addresses that nobody knows beforehand, tables that are read-only once it runs.
function(truebearing_harden target)
  target_compile_options(${target} PRIVATE -fstack-protector-strong)
  target_link_options(${target} PRIVATE -Wl,-z,relro,-z,now)
  get_target_property(type ${target} TYPE)
  if(type MATCHES "STATIC|SHARED|MODULE")
    # In a static library too, so that a module can hold it. Our own calls stay direct, as in a program.
    set_target_properties(${target} PROPERTIES POSITION_INDEPENDENT_CODE ON)
    target_compile_options(${target} PRIVATE -fno-semantic-interposition)
  else()
    target_compile_options(${target} PRIVATE -fPIE)
    target_link_options(${target} PRIVATE -pie)
  endif()
  if(NOT TRUEBEARING_SANITIZE)  # which checks more by itself
    target_compile_options(${target} PRIVATE
      $<$<CONFIG:Release,RelWithDebInfo,MinSizeRel>:-U_FORTIFY_SOURCE;-D_FORTIFY_SOURCE=2>)
  endif()
endfunction()

# truebearing_simd_sources(FILE...): loops written for SIMD (core/simd_dispatch.hpp); floating-point traps and errno would
# keep the compiler from it. No precompiled header: with it g++ takes the options that the header was compiled with.
function(truebearing_simd_sources)
  set_source_files_properties(${ARGN} TARGET_DIRECTORY truebearing PROPERTIES SKIP_PRECOMPILE_HEADERS ON
                              COMPILE_OPTIONS "-fopenmp-simd;-fno-trapping-math;-fno-math-errno;-ffp-contract=fast")
endfunction()

# truebearing_scalar_sources(FILE...): small matrices, coefficient by coefficient. A vector of two that have just been
# stored one by one waits until both have left the processor's store buffer; in a filter's step, which is one chain, that
# costs more than it saves. No precompiled header, as above.
function(truebearing_scalar_sources)
  set_source_files_properties(${ARGN} TARGET_DIRECTORY truebearing PROPERTIES SKIP_PRECOMPILE_HEADERS ON)
  set_property(SOURCE ${ARGN} TARGET_DIRECTORY truebearing APPEND PROPERTY COMPILE_OPTIONS -fno-tree-vectorize)
endfunction()

# truebearing_leave_unsanitized(FILE...): nothing but dense arithmetic, no input and no memory of its own, long to compile
# and what most of a run's time is spent in: not instrumented where a sanitizer runs. No precompiled header, which is.
function(truebearing_leave_unsanitized)
  if(TRUEBEARING_SANITIZE)
    set_source_files_properties(${ARGN} TARGET_DIRECTORY truebearing PROPERTIES SKIP_PRECOMPILE_HEADERS ON
                                COMPILE_OPTIONS "-fno-sanitize=all")
  endif()
endfunction()

# truebearing_build_by_room(TARGET [ALONE file...]): with TRUEBEARING_BUILD_BY_ROOM the files of one folder are one
# translation unit, since most of a file's time goes into the headers and templates that its neighbours read too. Alone
# stay those that are long by themselves and those with options of their own. Names without a linkage are therefore
# unique within a room; the dev preset compiles file by file and shows which include is missing.
function(truebearing_build_by_room target)
  if(NOT TRUEBEARING_BUILD_BY_ROOM)
    return()
  endif()
  cmake_parse_arguments(PARSE_ARGV 1 room "" "" ALONE)
  set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_MODE GROUP)
  get_target_property(sources ${target} SOURCES)
  foreach(source IN LISTS sources)
    cmake_path(ABSOLUTE_PATH source BASE_DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR})
    cmake_path(GET source FILENAME file)
    cmake_path(GET source PARENT_PATH folder)
    cmake_path(GET folder FILENAME folder)
    if(NOT file IN_LIST room_ALONE)
      set_source_files_properties(${source} TARGET_DIRECTORY ${target} PROPERTIES UNITY_GROUP ${folder})
    endif()
  endforeach()
endfunction()

# truebearing_precompile(TARGET): the headers of others that nearly every file reads, parsed once. Not worth its while
# where a few translation units are the whole target.
function(truebearing_precompile target)
  target_precompile_headers(${target} PRIVATE ${PROJECT_SOURCE_DIR}/src/precompiled.hpp)
endfunction()
