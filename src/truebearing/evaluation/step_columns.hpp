// SPDX-License-Identifier: Apache-2.0
// Steps of one run that are scored together: what truth and estimate differ by, and the covariance of the estimate, as
// columns of a lane for each step.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace truebearing {

class StepColumns {
 public:
  static constexpr int kSteps = 8;  // the doubles of the widest register

  /// Of n components.
  explicit StepColumns(int n) : n_(n), values_(static_cast<std::size_t>((n + n * (n + 1) / 2) * kSteps)) {}

  /// [lane]: difference i; element i, j of the covariance, i >= j.
  double* d(int i) { return column(i); }
  const double* d(int i) const { return column(i); }
  double* P(int i, int j) { return column(n_ + i * (i + 1) / 2 + j); }
  const double* P(int i, int j) const { return column(n_ + i * (i + 1) / 2 + j); }

  int steps = 0;                               ///< that have come
  std::array<std::size_t, kSteps> place = {};  ///< [lane]: of their figures in the score

 private:
  double* column(int i) { return values_.data() + i * kSteps; }
  const double* column(int i) const { return values_.data() + i * kSteps; }

  int n_;
  std::vector<double> values_;
};

/// How far the estimate of each step is off in some components.
struct StepDistances {
  double norm[StepColumns::kSteps];          ///< of their differences d
  double squared_by_P[StepColumns::kSteps];  ///< d' P^-1 d; NaN where their P has a pivot that is not positive
};

namespace kernels {

/// Of the n components that stand at `places`. By elimination as in mahalanobis_squared().
void distances(const StepColumns& steps, const int* places, int n, StepDistances& found);

}  // namespace kernels

}  // namespace truebearing
