// SPDX-License-Identifier: Apache-2.0
#include "truebearing/filter/shared_covariance_kernel.hpp"

#include <limits>

#include "truebearing/core/simd_width.hpp"

namespace truebearing::kernels {
namespace {

constexpr double kNone = -std::numeric_limits<double>::infinity();

template <int N>
struct MovingMeans {
  static constexpr auto n = static_cast<std::size_t>(N);

  template <typename Value>
  [[gnu::always_inline]] static inline void times(const double* F, Value (&x)[n]) {
    Value moved[n];
    for (std::size_t r = 0; r < n; ++r) {
      moved[r] = F[r] * x[0];
      for (std::size_t k = 1; k < n; ++k) moved[r] += F[r + k * n] * x[k];
    }
    for (std::size_t r = 0; r < n; ++r) x[r] = moved[r];
  }

  template <int kWidth>
  [[gnu::always_inline]] static inline void move_loops(const double* F, double* x, std::size_t count,
                                                       std::size_t stride) {
    using Vector = VectorOf<kWidth>;
    std::size_t i = 0;
    for (; i + kWidth <= count; i += kWidth) {
      typename Vector::Doubles some[n];
      for (std::size_t r = 0; r < n; ++r) Vector::load(x + r * stride + i, some[r]);
      times(F, some);
      for (std::size_t r = 0; r < n; ++r) Vector::store(some[r], x + r * stride + i);
    }
    for (; i < count; ++i) {
      double one[n];
      for (std::size_t r = 0; r < n; ++r) one[r] = x[r * stride + i];
      times(F, one);
      for (std::size_t r = 0; r < n; ++r) x[r * stride + i] = one[r];
    }
  }
  TRUEBEARING_FOR_WIDEST(move, (const double* F, double* x, std::size_t count, std::size_t stride),
                         (F, x, count, stride))
};

template <int kWidth>
[[gnu::always_inline]] inline void examine_loops(const double* values, std::size_t padded, bool& finite) {
  using Vector = VectorOf<kWidth>;
  typename Vector::Bits other{};
  for (std::size_t i = 0; i < padded; i += kWidth) {
    typename Vector::Doubles value;
    Vector::load(values + i, value);
    other |= reinterpret_cast<typename Vector::Bits>(value - value);  // zero of finite numbers only
  }
  finite = true;
  for (int lane = 0; lane < kWidth; ++lane) finite &= other[lane] == 0;
}
TRUEBEARING_FOR_WIDEST(examine, (const double* values, std::size_t padded, bool& finite), (values, padded, finite))

template <int N, int M>
struct TakingPositions {
  static constexpr auto n = static_cast<std::size_t>(N), m = static_cast<std::size_t>(M);

  // Of one member, or of as many as a register has room for.
  template <typename Value>
  [[gnu::always_inline]] static inline void take(const double* z, const double* K, const double* L,
                                                 const double* inverse_D, double log_determinant, Value (&x)[n],
                                                 Value& gained) {
    Value nu[m], y[m];  // y = L^-1 nu
    Value nis{};
    for (std::size_t c = 0; c < m; ++c) nu[c] = z[c] - x[c];
    for (std::size_t r = 0; r < m; ++r) {
      y[r] = nu[r];
      for (std::size_t c = 0; c < r; ++c) y[r] -= L[r + c * m] * y[c];
      nis += y[r] * y[r] * inverse_D[r];
    }
    const Value won = -0.5 * (nis + log_determinant);
    gained = won - won == 0.0 ? won : Value{} + kNone;
    for (std::size_t r = 0; r < n; ++r) {
      Value step{};
      for (std::size_t c = 0; c < m; ++c) step += K[r + c * n] * nu[c];
      x[r] += won - won == 0.0 ? step : Value{};
    }
  }

  template <int kWidth>
  [[gnu::always_inline]] static inline void take_all_loops(const double* z, const double* K, const double* L,
                                                           const double* inverse_D, double log_determinant, double* x,
                                                           std::size_t count, std::size_t stride, double* gained) {
    using Vector = VectorOf<kWidth>;
    std::size_t i = 0;
    for (; i + kWidth <= count; i += kWidth) {
      typename Vector::Doubles some[n], won;
      for (std::size_t r = 0; r < n; ++r) Vector::load(x + r * stride + i, some[r]);
      take(z, K, L, inverse_D, log_determinant, some, won);
      for (std::size_t r = 0; r < n; ++r) Vector::store(some[r], x + r * stride + i);
      Vector::store(won, gained + i);
    }
    for (; i < count; ++i) {
      double one[n];
      for (std::size_t r = 0; r < n; ++r) one[r] = x[r * stride + i];
      take(z, K, L, inverse_D, log_determinant, one, gained[i]);
      for (std::size_t r = 0; r < n; ++r) x[r * stride + i] = one[r];
    }
  }
  TRUEBEARING_FOR_WIDEST(take_all,
                         (const double* z, const double* K, const double* L, const double* inverse_D,
                          double log_determinant, double* x, std::size_t count, std::size_t stride, double* gained),
                         (z, K, L, inverse_D, log_determinant, x, count, stride, gained))
};

template <int N>
struct MixingMeans {
  template <int kWidth>
  [[gnu::always_inline]] static inline void mix_loops(const double* weights, double sum_w, const double* x,
                                                      std::size_t stride, double* mean, double* spread) {
    using Vector = VectorOf<kWidth>;
    using Doubles = typename Vector::Doubles;
    constexpr auto n = static_cast<std::size_t>(N);
    // Of the members without a weight nothing: they may be so far off that they are not finite.
    const auto load_weighed = [&](const Doubles& weight, const double* from, Doubles& value)
        __attribute__((always_inline)) {
      Vector::load(from, value);
      value = weight != 0.0 ? value : Doubles{};
    };
    TotalOf<kWidth> means[n], squares[n][n];
    for (std::size_t i = 0; i < stride; i += kWidth) {
      Doubles weight, value;
      Vector::load(weights + i, weight);
      for (std::size_t k = 0; k < n; ++k) {
        load_weighed(weight, x + k * stride + i, value);
        means[k].add(static_cast<int>(i), weight * value);
      }
    }
    for (std::size_t k = 0; k < n; ++k) mean[k] = means[k].sum() / sum_w;
    for (std::size_t i = 0; i < stride; i += kWidth) {
      Doubles weight, d[n];
      Vector::load(weights + i, weight);
      for (std::size_t k = 0; k < n; ++k) {
        load_weighed(weight, x + k * stride + i, d[k]);
        d[k] -= mean[k];
      }
      for (std::size_t r = 0; r < n; ++r)
        for (std::size_t c = 0; c <= r; ++c) squares[r][c].add(static_cast<int>(i), weight * d[r] * d[c]);
    }
    for (std::size_t r = 0; r < n; ++r)
      for (std::size_t c = 0; c <= r; ++c) spread[r + c * n] = spread[c + r * n] = squares[r][c].sum() / sum_w;
  }
  TRUEBEARING_FOR_WIDEST(mix,
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
  TakingPositions<N, M>().take_all(z, K, L, inverse_D, log_determinant, x, count, stride, gained);
}

bool all_finite(const double* values, std::size_t padded) {
  bool finite = false;
  examine(values, padded, finite);
  return finite;
}

double sum_of(const double* values, std::size_t count) {
  constexpr std::size_t kTogether = 4;
  double sums[kTogether]{};
  std::size_t i = 0;
  for (; i + kTogether <= count; i += kTogether)
    for (std::size_t lane = 0; lane < kTogether; ++lane) sums[lane] += values[i + lane];
  double total = (sums[0] + sums[2]) + (sums[1] + sums[3]);
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
