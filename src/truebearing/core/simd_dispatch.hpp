// One loop nest compiled twice: for any processor, and for those with AVX2 and fused multiply-add, chosen at run time.
//     TRUEBEARING_FOR_AVX2(name, (parameters), (arguments))
// defines name(parameters), which calls the always-inline function name_loops(arguments) in one of the two. The file
// that it stands in is compiled with truebearing_simd_sources() (cmake/compile_options.cmake).
#pragma once

#include <type_traits>

namespace truebearing {

/// Calls body(std::integral_constant<int, count>) for a count of 1 to 8, so that loops over it are unrolled, and for
/// any other with 0, which stands for a count that is not known beforehand.
template <typename Body>
[[gnu::always_inline]] inline void with_count(int count, const Body& body) {
  switch (count) {
    case 1:
      return body(std::integral_constant<int, 1>{});
    case 2:
      return body(std::integral_constant<int, 2>{});
    case 3:
      return body(std::integral_constant<int, 3>{});
    case 4:
      return body(std::integral_constant<int, 4>{});
    case 5:
      return body(std::integral_constant<int, 5>{});
    case 6:
      return body(std::integral_constant<int, 6>{});
    case 7:
      return body(std::integral_constant<int, 7>{});
    case 8:
      return body(std::integral_constant<int, 8>{});
    default:
      return body(std::integral_constant<int, 0>{});
  }
}

}  // namespace truebearing

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
