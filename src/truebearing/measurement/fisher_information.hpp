// SPDX-License-Identifier: Apache-2.0
// Fisher information of measurements about the state x0 (n) of a target whose motion is known but for x0:
//     J(x0) = sum_i (H_i Phi_i)' R_i^-1 (H_i Phi_i),  H_i at the true state, Phi_i = dx(t_i) / dx0.
// Its inverse is the Cramer-Rao bound of unbiased estimators; with a prior's information added, the posterior bound.
// Van Trees 1968, sec. 2.4; Nardone, Lindgren and Gong 1984 for bearings.
#pragma once

#include <Eigen/Core>

#include "truebearing/core/linear_algebra.hpp"
#include "truebearing/measurement/measurement_model.hpp"

namespace truebearing {

/// What one measurement of the true state x, reached by Phi (states of the model x n), adds to the information (n x n).
template <MeasurementModel Model, int Parameters>
Eigen::Matrix<typename Model::Scalar, Parameters, Parameters> fisher_information(
    const Model& model, const Eigen::Matrix<typename Model::Scalar, Model::kStates, 1>& x,
    const Eigen::Matrix<typename Model::Scalar, Model::kStates, Parameters>& Phi) {
  const Eigen::Matrix<typename Model::Scalar, Model::kMeasurements, Parameters> G = model.H(x) * Phi;
  const Eigen::Matrix<typename Model::Scalar, Model::kMeasurements, Model::kMeasurements> R = model.R();
  const Eigen::Matrix<typename Model::Scalar, Model::kMeasurements, Parameters> weighted = solve_positive(R, G);
  return G.transpose() * weighted;
}

}  // namespace truebearing
