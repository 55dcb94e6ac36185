// Vectors and matrices whose size is known at run time but bounded at compile time: no heap, cheap to pass.
// States, measurements and covariances cross the seams of the house in these.
#pragma once

#include <Eigen/Core>

namespace truebearing {

inline constexpr int kMaxDimension = 8;

using BoundedVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMaxDimension, 1>;
using BoundedMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMaxDimension, kMaxDimension>;

/// Of a multiple-model filter: a probability for each mode (r), and the transitions between them (r x r).
inline constexpr int kMaxModes = 10;
using ModeVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMaxModes, 1>;
using ModeMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMaxModes, kMaxModes>;

}  // namespace truebearing
