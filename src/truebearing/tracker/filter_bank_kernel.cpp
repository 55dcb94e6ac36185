// SPDX-License-Identifier: Apache-2.0
#include "truebearing/tracker/filter_bank_kernel.hpp"

#include <limits>

#include "truebearing/core/simd_exponential.hpp"
#include "truebearing/core/simd_width.hpp"

namespace truebearing::kernels {
namespace {

constexpr double kNone = -std::numeric_limits<double>::infinity();
constexpr double kLeast = -708.0;  // that exponential() takes

template <int kWidth>
[[gnu::always_inline]] inline void gain_loops(const double* gained, std::size_t padded, double* log_weights,
                                              bool& any) {
  using Vector = VectorOf<kWidth>;
  typename Vector::Doubles most = typename Vector::Doubles{} + kNone;
  for (std::size_t i = 0; i < padded; i += kWidth) {
    typename Vector::Doubles a, b;
    Vector::load(gained + i, a);
    Vector::load(log_weights + i, b);
    b += a;
    most = b > most ? b : most;
  }
  double largest = most[0];
  for (int lane = 1; lane < kWidth; ++lane) largest = most[lane] > largest ? most[lane] : largest;
  any = largest > kNone;
  if (!any) return;
  for (std::size_t i = 0; i < padded; i += kWidth) {
    typename Vector::Doubles a, b;
    Vector::load(gained + i, a);
    Vector::load(log_weights + i, b);
    b = (b + a) - largest;
    Vector::store(b, log_weights + i);
  }
}
TRUEBEARING_FOR_WIDEST(gain, (const double* gained, std::size_t padded, double* log_weights, bool& any),
                       (gained, padded, log_weights, any))

template <int kWidth>
[[gnu::always_inline]] inline void weigh_loops(const double* log_weights, std::size_t padded, double* weights,
                                               double& total) {
  using Vector = VectorOf<kWidth>;
  TotalOf<kWidth> all;
  for (std::size_t i = 0; i < padded; i += kWidth) {
    typename Vector::Doubles logarithm;
    Vector::load(log_weights + i, logarithm);
    typename Vector::Doubles weight = logarithm;
    exponential<kWidth>(weight);
    weight = logarithm >= kLeast ? weight : typename Vector::Doubles{};
    all.add(static_cast<int>(i), weight);
    Vector::store(weight, weights + i);
  }
  total = all.sum();
}
TRUEBEARING_FOR_WIDEST(weigh, (const double* log_weights, std::size_t padded, double* weights, double& total),
                       (log_weights, padded, weights, total))

}  // namespace

bool gain_weights(const double* gained, std::size_t padded, double* log_weights) {
  bool any = false;
  gain(gained, padded, log_weights, any);
  return any;
}

double weights_of(const double* log_weights, std::size_t padded, double* weights) {
  double total = 0.0;
  weigh(log_weights, padded, weights, total);
  return total;
}

}  // namespace truebearing::kernels
