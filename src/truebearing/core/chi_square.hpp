// SPDX-License-Identifier: Apache-2.0
// Chi-square quantiles for gates, coverage and consistency tests.
#pragma once

namespace truebearing {

/// The x with P(chi-square with `degrees_of_freedom` <= x) = probability. probability in (0, 1), degrees_of_freedom >
/// 0.
double chi_square_quantile(double probability, double degrees_of_freedom);

/// Where 95 % of the means of `count` independent chi-squares of so many degrees of freedom lie; NaN where there is none.
/// Of NEES and NIS over runs: whether a tracker knows its errors.
struct ChiSquareMeans {
  double low;
  double high;
};
ChiSquareMeans chi_square_means(double count, double degrees_of_freedom);

/// Quantile of the standard normal distribution.
double normal_quantile(double probability);

}  // namespace truebearing
