// SPDX-License-Identifier: Apache-2.0
// Correction models made by hand or at random, for tests that want one without training it.
#pragma once

#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "truebearing/core/random.hpp"
#include "truebearing/correction/correction_model.hpp"

namespace truebearing::testing {

/// A gate whose box is [low, high] in every feature; without `largest_disagreement`, one that asks nothing else.
inline BoxGate box(Eigen::Index features, double low, double high,
                   double largest_disagreement = std::numeric_limits<double>::infinity()) {
  BoxGate gate;
  gate.low = Eigen::VectorXd::Constant(features, low);
  gate.high = Eigen::VectorXd::Constant(features, high);
  gate.largest_disagreement = largest_disagreement;
  return gate;
}

inline FuzzyNetwork::Parameters random_parameters(RandomStream& random, Eigen::Index inputs, Eigen::Index rules,
                                                  Eigen::Index outputs) {
  const auto normal = [&] { return random.normal(); };
  const auto positive = [&] { return random.uniform(0.3, 2.0); };
  return {.input_mean = Eigen::VectorXd::NullaryExpr(inputs, normal),
          .input_scale = Eigen::VectorXd::NullaryExpr(inputs, positive),
          .input_clip = 4.0,
          .centres = Eigen::MatrixXd::NullaryExpr(rules, inputs, normal),
          .widths = Eigen::MatrixXd::NullaryExpr(rules, inputs, positive),
          .consequents = Eigen::MatrixXd::NullaryExpr(rules, outputs, normal),
          .output_scale = Eigen::VectorXd::NullaryExpr(outputs, positive)};
}

/// A model on a line over the trackers of those names, with the features given and whatever the network says.
inline CorrectionModel line_model(std::vector<FeatureSpec> features, FuzzyNetwork::Parameters parameters,
                                  const std::string& base = "plain", const std::string& reference = "plain",
                                  const std::string& covariance_of = "plain") {
  CorrectionModel model;
  model.space = &line_space();
  model.design.base = base;
  model.design.reference = reference;
  model.design.covariance_of = covariance_of;
  for (const std::string& name : {base, reference, covariance_of}) model.trackers[name] = "made by hand";
  model.design.features = std::move(features);
  const Eigen::Index rules = parameters.centres.rows();
  model.network = RuleBase{.network = FuzzyNetwork(std::move(parameters)),
                           .inflation = Eigen::VectorXd::Ones(rules),
                           .moments = {},
                           .usage = Eigen::VectorXd::Constant(rules, 1.0 / static_cast<double>(rules)),
                           .local_mean = Eigen::MatrixXd::Zero(rules, line_space().size())};
  return model;
}

/// The features of the corrected tracker in the 1-D radar family.
inline std::vector<FeatureSpec> radar_features() {
  return {{.kind = FeatureKind::log_step},
          {.kind = FeatureKind::companion_difference, .component = "position_m", .companion = "wide", .scale = 1000.0},
          {.kind = FeatureKind::companion_difference, .component = "velocity_mps", .companion = "wide", .scale = 100.0},
          {.kind = FeatureKind::log_mean_nis, .offset = 0.05}};
}

inline std::shared_ptr<const CorrectionModel> shared(CorrectionModel model) {
  return std::make_shared<const CorrectionModel>(std::move(model));
}

}  // namespace truebearing::testing
