// SPDX-License-Identifier: Apache-2.0
// What a measurement model is. A model is a value made for the step: it carries that measurement's sensor position and
// standard deviations. x is the state (n), z the measurement (m), H the Jacobian of h (m x n), R the noise covariance
// (m x m).
#pragma once

#include <Eigen/Core>
#include <concepts>

namespace truebearing {

/// z = h(x) + v, v ~ N(0, R). Innovations are residual(z, z_pred), never z - z_pred, so that angles wrap in one place.
template <typename Model>
concept MeasurementModel = requires(const Model& model,
                                    const Eigen::Matrix<typename Model::Scalar, Model::kStates, 1>& x,
                                    const Eigen::Matrix<typename Model::Scalar, Model::kMeasurements, 1>& z) {
  { model.h(x) } -> std::convertible_to<Eigen::Matrix<typename Model::Scalar, Model::kMeasurements, 1>>;
  { model.H(x) } -> std::convertible_to<Eigen::Matrix<typename Model::Scalar, Model::kMeasurements, Model::kStates>>;
  {
    model.R()
    } -> std::convertible_to<Eigen::Matrix<typename Model::Scalar, Model::kMeasurements, Model::kMeasurements>>;
  { model.residual(z, z) } -> std::convertible_to<Eigen::Matrix<typename Model::Scalar, Model::kMeasurements, 1>>;
};

}  // namespace truebearing
