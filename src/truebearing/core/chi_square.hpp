// SPDX-License-Identifier: Apache-2.0
// Chi-square quantiles for gates, coverage and consistency tests.
#pragma once

namespace truebearing {

/// The x with P(chi-square with `degrees_of_freedom` <= x) = probability. probability in (0, 1), degrees_of_freedom >
/// 0.
double chi_square_quantile(double probability, double degrees_of_freedom);

/// Quantile of the standard normal distribution.
double normal_quantile(double probability);

}  // namespace truebearing
