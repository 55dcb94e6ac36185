// SPDX-License-Identifier: Apache-2.0
#include "truebearing/tma/batch_estimate.hpp"

#include <algorithm>

#include "truebearing/core/linear_algebra.hpp"
#include "truebearing/motion/constant_velocity.hpp"

namespace truebearing {

Eigen::Matrix4d covariance_of(const Eigen::Matrix4d& information) {
  constexpr double kLeast = 1e-12;
  const Eigen::Vector4d scale = information.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const Eigen::Matrix4d scaled = scale.asDiagonal() * information * scale.asDiagonal();
  const SymmetricModes<4> modes = symmetric_modes(scaled);
  const Eigen::Vector4d inverse = modes.values.cwiseMax(kLeast).cwiseInverse();
  const Eigen::Matrix4d half = scale.asDiagonal() * modes.vectors * inverse.cwiseSqrt().asDiagonal();
  return half * half.transpose();
}

void carry(double t, Eigen::Vector4d& x, Eigen::Matrix4d& P) {
  const Eigen::Matrix4d F = ConstantVelocity<2, ContinuousWhiteNoise>{}.F(t);
  x = F * x;
  P = F * P * F.transpose();
  P = 0.5 * (P + P.transpose().eval());
}

}  // namespace truebearing
