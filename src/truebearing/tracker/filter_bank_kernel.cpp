// SPDX-License-Identifier: Apache-2.0
#include "truebearing/tracker/filter_bank_kernel.hpp"

#include <limits>

#include "truebearing/core/simd_dispatch.hpp"
#include "truebearing/core/simd_exponential.hpp"
#include "truebearing/core/simd_lanes.hpp"

namespace truebearing::kernels {
namespace {

constexpr double kNone = -std::numeric_limits<double>::infinity();
constexpr double kLeast = -708.0;  // that exponential() takes

[[gnu::always_inline]] inline void gain_loops(const double* gained, std::size_t padded, double* log_weights,
                                              bool& any) {
  Lanes most = Lanes{} + kNone;
  for (std::size_t i = 0; i < padded; i += kLanes) {
    Lanes a, b;
    load(gained + i, a);
    load(log_weights + i, b);
    b += a;
    most = b > most ? b : most;
  }
  double largest = most[0];
  for (int lane = 1; lane < kLanes; ++lane) largest = most[lane] > largest ? most[lane] : largest;
  any = largest > kNone;
  if (!any) return;
  for (std::size_t i = 0; i < padded; i += kLanes) {
    Lanes a, b;
    load(gained + i, a);
    load(log_weights + i, b);
    b = (b + a) - largest;
    store(b, log_weights + i);
  }
}
TRUEBEARING_FOR_AVX2(gain, (const double* gained, std::size_t padded, double* log_weights, bool& any),
                     (gained, padded, log_weights, any))

[[gnu::always_inline]] inline void weigh_loops(const double* log_weights, std::size_t padded, double* weights,
                                               double& total) {
  Lanes all{};
  for (std::size_t i = 0; i < padded; i += kLanes) {
    Lanes logarithm;
    load(log_weights + i, logarithm);
    Lanes weight = logarithm;
    exponential<kLanes>(weight);
    weight = logarithm >= kLeast ? weight : Lanes{};
    all += weight;
    store(weight, weights + i);
  }
  total = sum(all);
}
TRUEBEARING_FOR_AVX2(weigh, (const double* log_weights, std::size_t padded, double* weights, double& total),
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
