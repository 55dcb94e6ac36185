// SPDX-License-Identifier: Apache-2.0
// The rows that all benchmarks of a recurrent network are asked: a track of 8 features. Times are per step.
#pragma once

#include <Eigen/Core>
#include <utility>

#include "truebearing/correction/gated_recurrent.hpp"
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

inline GatedRecurrent network(int units, int encoded) {
  constexpr int kEntries = kOutputs * (kOutputs + 1) / 2;
  GatedRecurrent::Parameters p;
  p.input_mean = Eigen::VectorXd::Zero(kFeatures);
  p.input_scale = Eigen::VectorXd::Ones(kFeatures);
  p.output_scale = Eigen::VectorXd::Ones(kOutputs);
  if (encoded > 0) {
    p.encoder_weight = spread(encoded, kFeatures, 0.5);
    p.encoder_bias = spread(encoded, 1, 0.5);
  }
  p.weight_ih = spread(3 * units, encoded > 0 ? encoded : kFeatures, 0.3);
  p.weight_hh = spread(3 * units, units, 0.3);
  p.bias_ih = spread(3 * units, 1, 0.3);
  p.bias_hh = spread(3 * units, 1, 0.3);
  p.output_weight = spread(kOutputs, units, 0.3);
  p.output_bias = spread(kOutputs, 1, 0.3);
  p.covariance_weight = spread(kEntries, units, 0.1);
  p.covariance_bias = spread(kEntries, 1, 0.1);
  return GatedRecurrent(std::move(p));
}

}  // namespace truebearing::bench
