# truebearing_options(TARGET): the warnings, optimisation and sanitizers that every target of the house shares.
function(truebearing_options target)
  target_compile_features(${target} PUBLIC cxx_std_20)
  target_compile_options(${target} PRIVATE -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wsign-conversion
                                           $<$<BOOL:${TRUEBEARING_WARNINGS_AS_ERRORS}>:-Werror>)
  # The same bits on every build of one machine: no contraction into fused multiply-adds, whatever -march says.
  target_compile_options(${target} PRIVATE -ffp-contract=off -fno-math-errno)
  if(TRUEBEARING_SANITIZE)
    # Left out are the four checks of every pointer, which double the time to compile Eigen; the address sanitizer
    # sees the accesses themselves.
    target_compile_options(${target} PRIVATE -fsanitize=${TRUEBEARING_SANITIZE}
                           -fno-sanitize=null,alignment,object-size,vptr -fno-sanitize-recover=all
                                             -fno-omit-frame-pointer)
    target_link_options(${target} PUBLIC -fsanitize=${TRUEBEARING_SANITIZE})
  endif()
endfunction()

# truebearing_simd_sources(FILE...): loops written for SIMD (core/simd_dispatch.hpp); floating-point traps and errno would
# keep the compiler from it. No precompiled header: with it g++ takes the options that the header was compiled with.
function(truebearing_simd_sources)
  set_source_files_properties(${ARGN} TARGET_DIRECTORY truebearing PROPERTIES SKIP_PRECOMPILE_HEADERS ON
                              COMPILE_OPTIONS "-fopenmp-simd;-fno-trapping-math;-fno-math-errno;-ffp-contract=fast")
endfunction()

# truebearing_leave_unsanitized(FILE...): nothing but dense arithmetic, no input and no memory of its own, and long to
# compile: not instrumented and not optimised where a sanitizer runs. No precompiled header, which is instrumented.
function(truebearing_leave_unsanitized)
  if(TRUEBEARING_SANITIZE)
    set_source_files_properties(${ARGN} TARGET_DIRECTORY truebearing PROPERTIES SKIP_PRECOMPILE_HEADERS ON
                                COMPILE_OPTIONS "-fno-sanitize=all;-O0")
  endif()
endfunction()

# truebearing_precompile(TARGET [HEADER...]): the headers of others that nearly every file reads, and those of its own,
# parsed once.
function(truebearing_precompile target)
  target_precompile_headers(${target} PRIVATE ${PROJECT_SOURCE_DIR}/src/precompiled.hpp ${ARGN})
endfunction()
