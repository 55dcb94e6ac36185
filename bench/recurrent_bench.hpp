// SPDX-License-Identifier: Apache-2.0
// The rows that all benchmarks of a recurrent network are asked: a track of 8 features. Times are per step.
#pragma once

#include <Eigen/Core>
#include <cmath>

namespace truebearing::bench {

inline constexpr int kRows = 512;
inline constexpr int kFeatures = 8;
inline constexpr int kOutputs = 4;

/// Numbers that look random and cost nothing to repeat, in [-size, size].
inline Eigen::MatrixXf spread(Eigen::Index rows, Eigen::Index columns, double size) {
  Eigen::MatrixXf values(rows, columns);
  for (Eigen::Index i = 0; i < values.size(); ++i)
    values(i) = static_cast<float>(size * std::sin(12.9898 * static_cast<double>(i + 1)));
  return values;
}

}  // namespace truebearing::bench
