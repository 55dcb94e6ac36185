// SPDX-License-Identifier: Apache-2.0
// One loop nest compiled thrice, where registers of eight doubles are worth having: like simd_dispatch.hpp, and for
// processors with AVX-512 besides.
//     TRUEBEARING_FOR_WIDEST(name, (parameters), (arguments))
// defines name(parameters), which calls the always-inline function name_loops<kWidth>(arguments), kWidth the doubles
// that it works on together: 8 with AVX-512, else 4.
#pragma once

#include <cstdint>

namespace truebearing {

/// So many doubles, and as many integers of their size, in the vector extension of GCC and Clang.
template <int kCount>
struct VectorOf {
  using Doubles [[gnu::vector_size(kCount * sizeof(double))]] = double;
  using Bits [[gnu::vector_size(kCount * sizeof(std::int64_t))]] = std::int64_t;
  using BitsInMemory
      [[gnu::vector_size(kCount * sizeof(std::int64_t)), gnu::aligned(alignof(std::int64_t)), gnu::may_alias]] =
          std::int64_t;
  using InMemory [[gnu::vector_size(kCount * sizeof(double)), gnu::aligned(alignof(double)), gnu::may_alias]] = double;

  [[gnu::always_inline]] static void load(const double* from, Doubles& vector) {
    vector = *reinterpret_cast<const InMemory*>(from);
  }
  [[gnu::always_inline]] static void store(const Doubles& vector, double* to) {
    *reinterpret_cast<InMemory*>(to) = vector;
  }
};

/// A sum of numbers that are added four or eight at a time, in one order: first those that stand eight apart,
/// then those of eight that stand four apart.
template <int kCount>
class TotalOf {
  using Doubles = typename VectorOf<kCount>::Doubles;
  static_assert(kCount == 4 || kCount == 8);
  static constexpr int kParts = 8 / kCount;

 public:
  [[gnu::always_inline]] TotalOf() {
    for (Doubles& part : parts_) part = Doubles{};
  }
  /// Those that begin at place `first`, a multiple of kCount.
  [[gnu::always_inline]] void add(int first, const Doubles& value) { parts_[first / kCount % kParts] += value; }
  [[gnu::always_inline]] double sum() const {
    typename VectorOf<4>::Doubles four;
    if constexpr (kCount == 4) {
      four = parts_[0] + parts_[1];
    } else {
      const Doubles& all = parts_[0];
      four = __builtin_shufflevector(all, all, 0, 1, 2, 3) + __builtin_shufflevector(all, all, 4, 5, 6, 7);
    }
    return (four[0] + four[2]) + (four[1] + four[3]);
  }

 private:
  Doubles parts_[static_cast<unsigned>(kParts)];
};

/// The least multiple of the widest register's doubles that holds so many: what is padded to it can be loaded without a
/// rest on any processor.
constexpr int padded_to_widest(int count) {
  constexpr int kWidest = 8;
  return (count + kWidest - 1) / kWidest * kWidest;
}

}  // namespace truebearing

#if defined(__x86_64__) && defined(__GNUC__)
#if defined(__clang__)
#define TRUEBEARING_AVX512 "avx2,fma,avx512f,avx512dq,avx512vl"
#else
#define TRUEBEARING_AVX512 "avx2,fma,avx512f,avx512dq,avx512vl,prefer-vector-width=512"
#endif
#define TRUEBEARING_FOR_WIDEST(name, parameters, arguments)                                                  \
  [[gnu::target(TRUEBEARING_AVX512)]] static void name##_avx512 parameters {                                 \
    name##_loops<8> arguments;                                                                               \
  }                                                                                                          \
  [[gnu::target("avx2,fma")]] static void name##_avx2 parameters {                                           \
    name##_loops<4> arguments;                                                                               \
  }                                                                                                          \
  static void name##_any parameters {                                                                        \
    name##_loops<4> arguments;                                                                               \
  }                                                                                                          \
  void name parameters {                                                                                     \
    static const bool has_avx2 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");            \
    static const bool has_avx512 = has_avx2 && __builtin_cpu_supports("avx512f") &&                          \
                                   __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl"); \
    if (has_avx512)                                                                                          \
      name##_avx512 arguments;                                                                               \
    else if (has_avx2)                                                                                       \
      name##_avx2 arguments;                                                                                 \
    else                                                                                                     \
      name##_any arguments;                                                                                  \
  }
#else
#define TRUEBEARING_FOR_WIDEST(name, parameters, arguments) \
  void name parameters {                                    \
    name##_loops<4> arguments;                              \
  }
#endif
