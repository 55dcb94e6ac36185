// What a motion model is. x is the state (n), dt the time to cross in seconds, F the transition (n x n), Q the process
// noise covariance gathered over dt (n x n).
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

}  // namespace truebearing
