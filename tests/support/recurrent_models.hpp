// SPDX-License-Identifier: Apache-2.0
// Recurrent networks drawn at random.
#pragma once

#include "tests/support/plane_trackers.hpp"
#include "truebearing/core/random.hpp"
#include "truebearing/correction/correction_model.hpp"

namespace truebearing::testing {

inline GatedRecurrent::Parameters recurrent_parameters(std::uint64_t seed, int d, int e, int H, int n) {
  RandomStream random({.seed = seed}, StreamId::test);
  const auto weights = [&](int rows, int columns) {
    return Eigen::MatrixXf::NullaryExpr(rows, columns, [&] { return static_cast<float>(0.5 * random.normal()); })
        .eval();
  };
  GatedRecurrent::Parameters p;
  p.input_mean = Eigen::VectorXd::NullaryExpr(d, [&] { return random.normal(); });
  p.input_scale = Eigen::VectorXd::NullaryExpr(d, [&] { return random.uniform(0.5, 2.0); });
  p.output_scale = Eigen::VectorXd::NullaryExpr(n, [&] { return random.uniform(1.0, 20.0); });
  if (e > 0) {
    p.encoder_weight = weights(e, d);
    p.encoder_bias = weights(e, 1);
  }
  p.weight_ih = weights(3 * H, e > 0 ? e : d);
  p.weight_hh = weights(3 * H, H);
  p.bias_ih = weights(3 * H, 1);
  p.bias_hh = weights(3 * H, 1);
  p.output_weight = weights(n, H);
  p.output_bias = weights(n, 1);
  p.covariance_weight = weights(n * (n + 1) / 2, H);
  p.covariance_bias = weights(n * (n + 1) / 2, 1);
  return p;
}

/// plane_model() with a recurrent network in place of its rules.
inline CorrectionModel recurrent_plane_model(std::uint64_t seed) {
  CorrectionModel model = plane_model(seed);
  model.design.network = NetworkKind::recurrent;
  model.network = GatedRecurrent(recurrent_parameters(seed, 6, 5, 11, 4));
  return model;
}

}  // namespace truebearing::testing
