// SPDX-License-Identifier: Apache-2.0
// Filters of filter_block.hpp as registers of its loops, and what is asked and summed of them.
#pragma once

#include <cstddef>

#include "truebearing/core/simd_width.hpp"
#include "truebearing/filter/factorization.hpp"
#include "truebearing/filter/filter_block.hpp"

namespace truebearing::kernels {

template <typename Item, int Count>
using List = Item[static_cast<std::size_t>(Count)];
template <typename Item, int Rows, int Cols>
using Table = Item[static_cast<std::size_t>(Rows)][static_cast<std::size_t>(Cols)];

// kWidth filters, from `first` on, as registers.
template <int kWidth>
struct Registers {
  using Vector = VectorOf<kWidth>;
  using Doubles = typename Vector::Doubles;
  using Bits = typename Vector::Bits;
  using Total = TotalOf<kWidth>;  // of all filters

  [[gnu::always_inline]] static void load(const OfFilters& from, int first, Doubles& to) {
    Vector::load(from.lane + first % kBlock, to);
  }
  [[gnu::always_inline]] static void store(const Doubles& from, int first, OfFilters& to) {
    Vector::store(from, to.lane + first % kBlock);
  }
  template <int N>
  [[gnu::always_inline]] static void load(const FilterBlock<N>& from, int first, List<Doubles, N>& x,
                                          Table<Doubles, N, N>& P) {
    for (int i = 0; i < N; ++i) {
      load(from.x[i], first, x[i]);
      for (int j = 0; j <= i; ++j) load(from.P[i][j], first, P[i][j]);
    }
    mirror<N>(P);
  }
  template <int N>
  [[gnu::always_inline]] static void store(const List<Doubles, N>& x, const Table<Doubles, N, N>& P, int first,
                                           FilterBlock<N>& to) {
    for (int i = 0; i < N; ++i) {
      store(x[i], first, to.x[i]);
      for (int j = 0; j < N; ++j) store(P[i > j ? i : j][i > j ? j : i], first, to.P[i][j]);
    }
  }
  template <int N>
  [[gnu::always_inline]] static void mirror(Table<Doubles, N, N>& P) {
    for (int j = 1; j < N; ++j)
      for (int i = 0; i < j; ++i) P[i][j] = P[j][i];
  }

  // What is asked of the lanes. By signs, since compilers take comparisons of the widest registers apart.
  class Verdict {
   public:
    [[gnu::always_inline]] void is_less(const Doubles& a, const Doubles& b) { yes_ &= reinterpret_cast<Bits>(a - b); }
    [[gnu::always_inline]] void is_not_less(const Doubles& a, const Doubles& b) {
      yes_ &= ~reinterpret_cast<Bits>(a - b);
    }
    [[gnu::always_inline]] void is_finite(const Doubles& a) { infinite_ |= reinterpret_cast<Bits>(a - a); }
    [[gnu::always_inline]] void store(int first, FilterMask& mask) const {
      *reinterpret_cast<typename Vector::BitsInMemory*>(mask.lane + first % kBlock) =
          yes_ & ~(infinite_ | (Bits{} - infinite_));
    }

   private:
    Bits yes_ = ~Bits{};  // the sign of a number of them
    Bits infinite_{};     // any bit of it, no number or infinite
  };

  // detail::is_plainly_positive_definite() of every lane; A is used up.
  template <int N>
  [[gnu::always_inline]] static void is_plainly_positive_definite(Table<Doubles, N, N>& A, List<Doubles, N>& least,
                                                                  Verdict& plainly) {
    constexpr double kShare = detail::kPlainShare<double>;
    if constexpr (N == 1) {
      plainly.is_less(least[0], A[0][0]);
      plainly.is_finite(A[0][0]);
    } else {
      const Doubles whole = A[0][0] * A[1][1], det = whole - A[1][0] * A[1][0];
      plainly.is_less(least[0], A[0][0]);
      plainly.is_less(least[1], A[1][1]);
      plainly.is_less(kShare * whole, det);
      plainly.is_finite(det);
      if constexpr (N > 2) {
        Table<Doubles, N - 2, N - 2> rest;
        List<Doubles, N - 2> rest_least;
        for (int j = 2; j < N; ++j) {
          const Doubles u = A[1][1] * A[j][0] - A[1][0] * A[j][1], v = A[0][0] * A[j][1] - A[1][0] * A[j][0];
          for (int i = j; i < N; ++i) rest[i - 2][j - 2] = det * A[i][j] - (u * A[i][0] + v * A[i][1]);
          rest_least[j - 2] = det * (kShare * A[j][j] + least[j]);
        }
        is_plainly_positive_definite<N - 2>(rest, rest_least, plainly);
      }
    }
  }

  template <int N>
  [[gnu::always_inline]] static void judge(const List<Doubles, N>& x, const Table<Doubles, N, N>& P, int first,
                                           FilterMask& good) {
    Table<Doubles, N, N> A;
    List<Doubles, N> least;
    Verdict verdict;
    for (int i = 0; i < N; ++i) {
      verdict.is_finite(x[i]);
      least[i] = Doubles{};
      for (int j = 0; j <= i; ++j) A[i][j] = P[i][j];
    }
    is_plainly_positive_definite<N>(A, least, verdict);
    verdict.store(first, good);
  }
};

}  // namespace truebearing::kernels
