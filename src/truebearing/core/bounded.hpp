// SPDX-License-Identifier: Apache-2.0
// Vectors and matrices whose size is known at run time but bounded at compile time: no heap, cheap to pass.
// States, measurements and covariances cross the seams of the house in these.
#pragma once

#include <Eigen/Core>

// Part of the layout of our records; the package's CMake target and its pkg-config file pass it.
static_assert(EIGEN_MAX_ALIGN_BYTES == 16 && EIGEN_MAX_STATIC_ALIGN_BYTES == 16,
              "truebearing is compiled with EIGEN_MAX_ALIGN_BYTES=16: compile with -DEIGEN_MAX_ALIGN_BYTES=16");

namespace truebearing {

inline constexpr int kMaxDimension = 10;

using BoundedVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMaxDimension, 1>;
using BoundedMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMaxDimension, kMaxDimension>;

/// Of a multiple-model filter: a probability for each mode (r), and the transitions between them (r x r).
inline constexpr int kMaxModes = 10;
using ModeVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMaxModes, 1>;
using ModeMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMaxModes, kMaxModes>;

}  // namespace truebearing
