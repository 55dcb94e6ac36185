// SPDX-License-Identifier: Apache-2.0
// One loop nest compiled twice: for any processor, and for those with AVX2 and fused multiply-add, chosen at run time.
//     TRUEBEARING_FOR_AVX2(name, (parameters), (arguments))
// defines name(parameters), which calls the always-inline function name_loops(arguments) in one of the two. The file
// that it stands in is compiled with truebearing_simd_sources() (cmake/compile_options.cmake).
#pragma once

#if defined(__x86_64__) && defined(__GNUC__)
#define TRUEBEARING_FOR_AVX2(name, parameters, arguments)                                         \
  [[gnu::target("avx2,fma")]] static void name##_avx2 parameters {                                \
    name##_loops arguments;                                                                       \
  }                                                                                               \
  static void name##_any parameters {                                                             \
    name##_loops arguments;                                                                       \
  }                                                                                               \
  void name parameters {                                                                          \
    static const bool has_avx2 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma"); \
    if (has_avx2)                                                                                 \
      name##_avx2 arguments;                                                                      \
    else                                                                                          \
      name##_any arguments;                                                                       \
  }
#else
#define TRUEBEARING_FOR_AVX2(name, parameters, arguments) \
  void name parameters {                                  \
    name##_loops arguments;                               \
  }
#endif
