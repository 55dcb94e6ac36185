// SPDX-License-Identifier: Apache-2.0
// The sample covariance of one interval, complex (M x M): what subspace methods that work on a whole interval look at,
// to begin with or instead of tracking.
#pragma once

#include <Eigen/Core>

#include "truebearing/array/interval.hpp"

namespace truebearing {

/// R = 1/Ns sum x x^H over the usable snapshots (M x M); rows and columns of dead sensors are zero.
void sample_covariance(const Interval& interval, Eigen::MatrixXcd& R);

/// The N eigenvectors of R with the largest eigenvalues (M x N), the largest first, and all eigenvalues, ascending (M).
/// By N <= M. Allocates.
struct SignalSubspace {
  Eigen::MatrixXcd basis;
  Eigen::VectorXd eigenvalues;
};
SignalSubspace signal_subspace(const Eigen::MatrixXcd& R, int N);

/// How many signals an interval holds, from the M eigenvalues of its covariance (ascending) and its number of
/// snapshots: minimum description length, or Akaike's criterion (Wax and Kailath 1985). At most M - 1.
enum class OrderCriterion { minimum_description_length, akaike };
int source_count(const Eigen::VectorXd& eigenvalues, int snapshots, OrderCriterion criterion);

}  // namespace truebearing
