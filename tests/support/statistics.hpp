// SPDX-License-Identifier: Apache-2.0
// Intervals for statistical tests: each is left by chance once in a hundred thousand seeds, and the seeds are fixed.
#pragma once

#include <cmath>
#include <vector>

#include "truebearing/core/chi_square.hpp"

namespace truebearing::testing {

inline constexpr double kMissProbability = 1e-5;

struct Moments {
  double mean = 0.0;
  double variance = 0.0;
};

inline Moments moments(const std::vector<double>& values) {
  const double count = static_cast<double>(values.size());
  Moments m;
  for (const double value : values) m.mean += value / count;
  for (const double value : values) m.variance += (value - m.mean) * (value - m.mean) / (count - 1.0);
  return m;
}

/// Half the width of the interval that holds the mean of `count` values of standard deviation sigma.
inline double mean_margin(double sigma, std::size_t count) {
  return normal_quantile(1.0 - 0.5 * kMissProbability) * sigma / std::sqrt(static_cast<double>(count));
}

/// Does a sum of squared normalised errors, of that many degrees of freedom, lie below, or above, what chi-square
/// leaves to chance?
inline bool is_too_small(double sum, double freedom) {
  return sum < chi_square_quantile(0.5 * kMissProbability, freedom);
}
inline bool is_too_large(double sum, double freedom) {
  return sum > chi_square_quantile(1.0 - 0.5 * kMissProbability, freedom);
}

/// Does the sample variance of `count` normal values fit the variance they should have?
inline bool variance_fits(double sample_variance, double variance, std::size_t count) {
  const double freedom = static_cast<double>(count) - 1.0;
  const double statistic = freedom * sample_variance / variance;
  return !is_too_small(statistic, freedom) && !is_too_large(statistic, freedom);
}

/// Pearson's statistic of counts against equal expectation.
inline bool counts_are_even(const std::vector<int>& counts) {
  double total = 0.0, statistic = 0.0;
  for (const int count : counts) total += count;
  const double expected = total / static_cast<double>(counts.size());
  for (const int count : counts) statistic += (count - expected) * (count - expected) / expected;
  return statistic < chi_square_quantile(1.0 - kMissProbability, static_cast<double>(counts.size()) - 1.0);
}

}  // namespace truebearing::testing
