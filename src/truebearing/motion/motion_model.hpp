// SPDX-License-Identifier: Apache-2.0
// What a motion model is. x is the state (n), dt the time to cross in seconds, F the transition or, of a nonlinear
// model, the Jacobian of f in x (n x n), Q the process noise covariance gathered over dt (n x n).
#pragma once

#include <Eigen/Core>
#include <concepts>

namespace truebearing {

/// x_{k+1} = F(dt) x_k + w, w ~ N(0, Q(dt)). F(0) = I and Q(0) = 0.
template <typename Model>
concept LinearMotionModel = requires(const Model& model, typename Model::Scalar dt_s) {
  { Model::kStates } -> std::convertible_to<int>;
  { model.F(dt_s) } -> std::convertible_to<Eigen::Matrix<typename Model::Scalar, Model::kStates, Model::kStates>>;
  { model.Q(dt_s) } -> std::convertible_to<Eigen::Matrix<typename Model::Scalar, Model::kStates, Model::kStates>>;
};

/// x_{k+1} = f(x_k, dt) + w, w ~ N(0, Q(dt)), F(x, dt) = df/dx at x. f(x, 0) = x, F(x, 0) = I and Q(0) = 0.
template <typename Model>
concept NonlinearMotionModel = requires(const Model& model,
                                        const Eigen::Matrix<typename Model::Scalar, Model::kStates, 1>& x,
                                        typename Model::Scalar dt_s) {
  { model.f(x, dt_s) } -> std::convertible_to<Eigen::Matrix<typename Model::Scalar, Model::kStates, 1>>;
  { model.F(x, dt_s) } -> std::convertible_to<Eigen::Matrix<typename Model::Scalar, Model::kStates, Model::kStates>>;
  { model.Q(dt_s) } -> std::convertible_to<Eigen::Matrix<typename Model::Scalar, Model::kStates, Model::kStates>>;
};

template <typename Model>
concept MotionModel = LinearMotionModel<Model> || NonlinearMotionModel<Model>;

}  // namespace truebearing
