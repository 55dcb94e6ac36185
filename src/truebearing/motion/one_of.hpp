// One of several linear motion models of the same state, chosen at run time: itself a linear motion model, so that one
// type of filter serves them all at the price of one branch for each of F and Q (n x n).
#pragma once

#include <Eigen/Core>
#include <type_traits>
#include <variant>

#include "truebearing/motion/motion_model.hpp"

namespace truebearing {

template <LinearMotionModel First, LinearMotionModel... Rest>
struct OneOf {
  using Scalar = typename First::Scalar;
  static constexpr int kStates = First::kStates;
  static_assert(((Rest::kStates == kStates && std::is_same_v<typename Rest::Scalar, Scalar>)&&...),
                "the models are of one state");
  using Matrix = Eigen::Matrix<Scalar, kStates, kStates>;

  std::variant<First, Rest...> model;

  Matrix F(Scalar dt_s) const {
    return std::visit([&](const auto& chosen) -> Matrix { return chosen.F(dt_s); }, model);
  }
  Matrix Q(Scalar dt_s) const {
    return std::visit([&](const auto& chosen) -> Matrix { return chosen.Q(dt_s); }, model);
  }
};

}  // namespace truebearing
