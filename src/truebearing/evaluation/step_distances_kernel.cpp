// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "truebearing/core/simd_width.hpp"
#include "truebearing/core/with_count.hpp"
#include "truebearing/evaluation/step_columns.hpp"

namespace truebearing::kernels {
namespace {

template <int kWidth, int N>
[[gnu::always_inline]] inline void distances_of(const StepColumns& steps, const int* places, StepDistances& found) {
  using Vector = VectorOf<kWidth>;
  using Doubles = typename Vector::Doubles;
  using Bits = typename Vector::Bits;
  constexpr auto n = static_cast<std::size_t>(N);
  for (int first = 0; first < StepColumns::kSteps; first += kWidth) {
    Doubles d[n], P[n][n], squares{}, squared_by_P{};
    Bits positive = ~Bits{};  // the sign of a number: a comparison of the widest registers is taken apart
    for (std::size_t j = 0; j < n; ++j) {
      Vector::load(steps.d(places[j]) + first, d[j]);
      squares += d[j] * d[j];
      for (std::size_t i = j; i < n; ++i)
        Vector::load(steps.P(std::max(places[i], places[j]), std::min(places[i], places[j])) + first, P[i][j]);
    }
    for (std::size_t k = 0; k < n; ++k) {
      positive &= reinterpret_cast<Bits>(0.0 - P[k][k]);  // where that is no number, no result is one
      const Doubles inverse = 1.0 / P[k][k];
      squared_by_P += d[k] * d[k] * inverse;
      for (std::size_t i = k + 1; i < n; ++i) {
        const Doubles factor = P[i][k] * inverse;
        d[i] -= factor * d[k];
        for (std::size_t j = k + 1; j <= i; ++j) P[i][j] -= factor * P[j][k];
      }
    }
    const Bits nan = ~(positive >> 63);
    Vector::store(squares, found.norm + first);
    Vector::store(reinterpret_cast<Doubles>(reinterpret_cast<Bits>(squared_by_P) | nan), found.squared_by_P + first);
  }
#pragma omp simd
  for (int lane = 0; lane < StepColumns::kSteps; ++lane) found.norm[lane] = std::sqrt(found.norm[lane]);
}

template <int kWidth>
[[gnu::always_inline]] inline void distances_loops(const StepColumns& steps, const int* places, int n,
                                                   StepDistances& found) {
  with_count(
      n, [&](auto known) __attribute__((always_inline)) {
        if constexpr (known > 0) distances_of<kWidth, int(known)>(steps, places, found);
      });
}

}  // namespace

TRUEBEARING_FOR_WIDEST(distances, (const StepColumns& steps, const int* places, int n, StepDistances& found),
                       (steps, places, n, found))

}  // namespace truebearing::kernels
