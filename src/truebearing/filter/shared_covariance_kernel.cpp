// SPDX-License-Identifier: Apache-2.0
#include "truebearing/filter/shared_covariance_kernel.hpp"

#include <cstdint>
#include <limits>

#include "truebearing/core/simd_dispatch.hpp"
#include "truebearing/core/simd_lanes.hpp"

namespace truebearing::kernels {
namespace {

constexpr double kNone = -std::numeric_limits<double>::infinity();

template <int N>
struct MovingMeans {
  [[gnu::always_inline]] static inline void move_loops(const double* F, double* x, std::size_t count,
                                                       std::size_t stride) {
    constexpr auto n = static_cast<std::size_t>(N);
#pragma omp simd
    for (std::size_t i = 0; i < count; ++i) {
      double moved[n];
      for (std::size_t r = 0; r < n; ++r) {
        moved[r] = F[r] * x[i];
        for (std::size_t k = 1; k < n; ++k) moved[r] += F[r + k * n] * x[k * stride + i];
      }
      for (std::size_t r = 0; r < n; ++r) x[r * stride + i] = moved[r];
    }
  }
  TRUEBEARING_FOR_AVX2(move, (const double* F, double* x, std::size_t count, std::size_t stride), (F, x, count, stride))
};

[[gnu::always_inline]] inline void examine_loops(const double* values, std::size_t padded, bool& finite) {
  using Mask [[gnu::vector_size(kLanes * sizeof(std::int64_t))]] = std::int64_t;
  Mask other{};
  for (std::size_t i = 0; i < padded; i += kLanes) {
    Lanes value;
    load(values + i, value);
    other |= value - value != 0.0;
  }
  finite = (other[0] | other[1] | other[2] | other[3]) == 0;
}
TRUEBEARING_FOR_AVX2(examine, (const double* values, std::size_t padded, bool& finite), (values, padded, finite))

template <int N, int M>
struct TakingPositions {
  [[gnu::always_inline]] static inline void take_loops(const double* z, const double* K, const double* L,
                                                       const double* inverse_D, double log_determinant, double* x,
                                                       std::size_t count, std::size_t stride, double* gained) {
    constexpr auto n = static_cast<std::size_t>(N), m = static_cast<std::size_t>(M);
#pragma omp simd
    for (std::size_t i = 0; i < count; ++i) {
      double nu[m], nis = 0.0;
      for (std::size_t c = 0; c < m; ++c) nu[c] = z[c] - x[c * stride + i];
      double y[m];  // L^-1 nu
      for (std::size_t r = 0; r < m; ++r) {
        y[r] = nu[r];
        for (std::size_t c = 0; c < r; ++c) y[r] -= L[r + c * m] * y[c];
        nis += y[r] * y[r] * inverse_D[r];
      }
      const double won = -0.5 * (nis + log_determinant);
      const bool valid = won - won == 0.0;
      gained[i] = valid ? won : kNone;
      for (std::size_t r = 0; r < n; ++r) {
        double step = 0.0;
        for (std::size_t c = 0; c < m; ++c) step += K[r + c * n] * nu[c];
        x[r * stride + i] += valid ? step : 0.0;
      }
    }
  }
  TRUEBEARING_FOR_AVX2(take,
                       (const double* z, const double* K, const double* L, const double* inverse_D,
                        double log_determinant, double* x, std::size_t count, std::size_t stride, double* gained),
                       (z, K, L, inverse_D, log_determinant, x, count, stride, gained))
};

template <int N>
struct MixingMeans {
  // Of the members without a weight nothing: they may be so far off that they are not finite.
  [[gnu::always_inline]] static inline void load_weighed(const Lanes& weight, const double* from, Lanes& x) {
    load(from, x);
    x = weight != 0.0 ? x : Lanes{};
  }

  [[gnu::always_inline]] static inline void mix_loops(const double* weights, double sum_w, const double* x,
                                                      std::size_t stride, double* mean, double* spread) {
    constexpr auto n = static_cast<std::size_t>(N);
    Lanes means[n]{}, squares[n][n]{};
    for (std::size_t i = 0; i < stride; i += kLanes) {
      Lanes weight, value;
      load(weights + i, weight);
      for (std::size_t k = 0; k < n; ++k) {
        load_weighed(weight, x + k * stride + i, value);
        means[k] += weight * value;
      }
    }
    for (std::size_t k = 0; k < n; ++k) mean[k] = sum(means[k]) / sum_w;
    for (std::size_t i = 0; i < stride; i += kLanes) {
      Lanes weight, d[n];
      load(weights + i, weight);
      for (std::size_t k = 0; k < n; ++k) {
        load_weighed(weight, x + k * stride + i, d[k]);
        d[k] -= mean[k];
      }
      for (std::size_t r = 0; r < n; ++r)
        for (std::size_t c = 0; c <= r; ++c) squares[r][c] += weight * d[r] * d[c];
    }
    for (std::size_t r = 0; r < n; ++r)
      for (std::size_t c = 0; c <= r; ++c) spread[r + c * n] = spread[c + r * n] = sum(squares[r][c]) / sum_w;
  }
  TRUEBEARING_FOR_AVX2(mix,
                       (const double* weights, double sum_w, const double* x, std::size_t stride, double* mean,
                        double* spread),
                       (weights, sum_w, x, stride, mean, spread))
};

}  // namespace

template <int N>
void move_means(const double* F, double* x, std::size_t count, std::size_t stride) {
  MovingMeans<N>().move(F, x, count, stride);
}

template <int N, int M>
void take_position(const double* z, const double* K, const double* L, const double* inverse_D, double log_determinant,
                   double* x, std::size_t count, std::size_t stride, double* gained) {
  TakingPositions<N, M>().take(z, K, L, inverse_D, log_determinant, x, count, stride, gained);
}

bool all_finite(const double* values, std::size_t padded) {
  bool finite = false;
  examine(values, padded, finite);
  return finite;
}

double sum_of(const double* values, std::size_t count) {
  Lanes sums{};
  std::size_t i = 0;
  for (; i + kLanes <= count; i += kLanes) {
    Lanes value;
    load(values + i, value);
    sums += value;
  }
  double total = sum(sums);
  for (; i < count; ++i) total += values[i];
  return total;
}

template <int N>
void mix_means(const double* weights, double sum_w, const double* x, std::size_t stride, double* mean, double* spread) {
  MixingMeans<N>().mix(weights, sum_w, x, stride, mean, spread);
}

#define TRUEBEARING_MEANS(N, M)                                                                                  \
  template void move_means<N>(const double*, double*, std::size_t, std::size_t);                                 \
  template void take_position<N, M>(const double*, const double*, const double*, const double*, double, double*, \
                                    std::size_t, std::size_t, double*);                                          \
  template void mix_means<N>(const double*, double, const double*, std::size_t, double*, double*)
TRUEBEARING_MEANS(2, 1);
TRUEBEARING_MEANS(3, 1);
TRUEBEARING_MEANS(4, 2);
TRUEBEARING_MEANS(5, 2);
TRUEBEARING_MEANS(6, 2);

}  // namespace truebearing::kernels
