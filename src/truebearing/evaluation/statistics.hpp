// SPDX-License-Identifier: Apache-2.0
// Statistics over Monte Carlo runs that every figure of a comparison is made of: pooled RMSE, means, medians and their
// standard errors. What cannot be said of so few values is NaN.
#pragma once

#include <cstddef>
#include <vector>

namespace truebearing {

/// Squared errors of one run, or of several: their sum and how many they are.
struct SquaredErrors {
  double sum = 0.0;
  double count = 0.0;

  void add(double error) {
    sum += error * error;
    count += 1.0;
  }
  void add(const SquaredErrors& other) {
    sum += other.sum;
    count += other.count;
  }
};

double root_mean(const SquaredErrors& errors);
double mean_square(const SquaredErrors& errors);

/// A figure and its standard error.
struct Estimate {
  double value;
  double se;
};

/// RMSE pooled over runs. Its standard error is the jackknife, one run left out at a time (Efron and Stein 1981); runs
/// without errors are passed over.
Estimate pooled_rmse(const std::vector<SquaredErrors>& runs);
/// Of one error per run.
Estimate rmse_of(const std::vector<double>& errors);
/// As pooled_rmse, without the root.
Estimate pooled_mse(const std::vector<SquaredErrors>& runs);

/// Mean of independent values.
Estimate mean_of(const std::vector<double>& values);
/// Mean of values that are 0 or 1. Its standard error is the standard deviation of the probability under Jeffreys' prior
/// (Brown, Cai and DasGupta 2001): that of a binomial where both are seen often, and not 0 where one of them never was.
Estimate share_of(const std::vector<double>& values);
Estimate share_of(double ones, double count);
/// Of independent values, the standard deviation, about the mean, over n - 1; its standard error is the jackknife.
Estimate standard_deviation_of(const std::vector<double>& values);
/// The middle; of an even number the mean of the two in the middle. Of numbers, of which none is NaN.
double median_of(const std::vector<double>& values);
/// The same of the places `lower` and `upper` of their ascending order, counted from 0, which are one or neighbours and
/// there.
double middle_of(const std::vector<double>& values, std::size_t lower, std::size_t upper);

}  // namespace truebearing
