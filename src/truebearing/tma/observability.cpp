// SPDX-License-Identifier: Apache-2.0
#include "truebearing/tma/observability.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "truebearing/core/linear_algebra.hpp"

namespace truebearing {

Observability observability(const Eigen::Matrix4d& A, const Eigen::Vector4d& y, double length_s,
                            const Eigen::Matrix4d& T) {
  constexpr double kLargestSigma = 0.5;
  const Eigen::Vector4d unit(1.0, 1.0 / length_s, 1.0 / length_s, -y[3]);  // dy / du
  const Eigen::Matrix4d information = unit.asDiagonal() * A * unit.asDiagonal();
  const SymmetricModes<4> modes = symmetric_modes(information);
  Observability result;
  result.rank = static_cast<int>((modes.values.array() > 1.0 / (kLargestSigma * kLargestSigma)).count());
  // What is left of the information on ln r when the other three have been fitted.
  const Eigen::Matrix3d others = information.topLeftCorner<3, 3>();
  const Eigen::Vector3d coupling = information.topRightCorner<3, 1>();
  const double left = information(3, 3) - coupling.dot(solve_semidefinite(others, coupling));
  // Less than rounding leaves of it is nothing.
  const bool known = left > 1e-9 * information(3, 3) && left > 0.0;
  result.log_range_sigma = known ? 1.0 / std::sqrt(left) : std::numeric_limits<double>::infinity();
  if (!known && result.rank == 4) result.rank = 3;
  const double sigma = 1.0 / std::sqrt(std::max(modes.values[0], 0.0));
  result.worst = std::min(sigma, kLargestSigma) * T * unit.asDiagonal() * modes.vectors.col(0);
  return result;
}

}  // namespace truebearing
