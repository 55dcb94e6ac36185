// SPDX-License-Identifier: Apache-2.0
// Trackers and a correction in the plane, for the tests of several rooms.
#pragma once

#include <memory>
#include <vector>

#include "tests/support/correction_models.hpp"
#include "truebearing/core/random.hpp"
#include "truebearing/correction/corrected_tracker.hpp"
#include "truebearing/filter/interacting_multiple_model.hpp"
#include "truebearing/filter/kalman.hpp"
#include "truebearing/motion/constant_velocity.hpp"
#include "truebearing/tracker/filter_tracker_of.hpp"
#include "truebearing/tracker/position_sensor.hpp"

namespace truebearing::testing {

using PlaneMotion = ConstantVelocity<2, DiscreteWhiteNoise>;

inline const PositionSensor<2> kPlaneSensor{{100.0, 100.0}, 1.0};

inline std::unique_ptr<Tracker> plane_tracker(double sigma_a_mps2) {
  return std::make_unique<FilterTrackerOf<KalmanFilter<4>, PlaneMotion, PositionSensor<2>>>(
      plane_space(), PlaneMotion{{sigma_a_mps2}}, kPlaneSensor, TwoPointStart{});
}

inline std::unique_ptr<Tracker> plane_imm() {
  InteractingMultipleModel::Modes modes;
  modes.push_back(state_of<KalmanFilter<4>>(PlaneMotion{{1.0}}));
  modes.push_back(state_of<KalmanFilter<4>>(PlaneMotion{{30.0}}));
  return std::make_unique<FilterTracker>(
      plane_space(), std::make_unique<InteractingMultipleModel>(std::move(modes), star_chain(2, 0.05, 0.1, 1.0, 1.0)),
      sensor_of(kPlaneSensor), TwoPointStart{});
}

inline Ensemble plane_ensemble() {
  Ensemble ensemble;
  ensemble.add("plain", plane_tracker(8.0));
  ensemble.add("tuned", plane_tracker(20.0));
  ensemble.add("imm", plane_imm());
  return ensemble;
}

/// A correction in the track frame with everything that one can have; its network is drawn at random, `size` in its
/// outputs.
inline CorrectionModel plane_model(std::uint64_t seed, double size = 1.0) {
  RandomStream random({.seed = seed}, StreamId::test);
  CorrectionModel model;
  model.space = &plane_space();
  model.design.base = model.design.covariance_of = "plain";
  model.design.reference = "tuned";
  model.design.covariance_moments = true;
  for (const char* name : {"plain", "tuned", "imm"}) model.trackers[name] = "made by hand";
  model.design.frame = Frame::track;
  model.design.output_in_sigma = true;
  for (const char* component : {"along_m", "cross_m"}) {
    FeatureSpec innovation, average;
    innovation.kind = FeatureKind::innovation;
    average.kind = FeatureKind::innovation_average;
    innovation.component = average.component = component;
    average.alpha = 0.2;
    model.design.features.insert(model.design.features.end(), {innovation, average});
  }
  FeatureSpec difference, mode;
  difference.kind = FeatureKind::companion_difference;
  difference.component = "cross_mps";
  difference.companion = "imm";
  difference.scale_is_sigma = true;
  mode.kind = FeatureKind::mode_probability;
  mode.companion = "imm";
  mode.mode = 2;
  model.design.features.insert(model.design.features.end(), {difference, mode});
  FuzzyNetwork::Parameters parameters = random_parameters(random, 6, 8, 4);
  parameters.consequents *= size;
  RuleBase& rules = model.rules();
  rules.network = FuzzyNetwork(std::move(parameters));
  model.gate = box(6, -50.0, 50.0);
  rules.moments.resize(8, 16);
  for (Eigen::Index j = 0; j < 8; ++j) {
    const Eigen::Matrix4d A = Eigen::Matrix4d::NullaryExpr([&] { return random.normal(); });
    const Eigen::Matrix4d square = A * A.transpose();
    rules.moments.row(j) = square.reshaped().transpose();
  }
  rules.usage = Eigen::VectorXd::Constant(8, 0.125);
  rules.local_mean = Eigen::MatrixXd::Zero(8, 4);
  return model;
}

/// Positions of a target that turns, every second, with noise of 100 m.
inline std::vector<Measurement> plane_log(std::uint64_t seed, int steps) {
  RandomStream random({.seed = seed}, StreamId::test);
  std::vector<Measurement> log;
  Eigen::Vector2d position(3000.0, 9000.0);
  for (int k = 1; k <= steps; ++k) {
    const double course = 0.4 + (k % 60 > 20 ? 0.05 * (k % 60 - 20) : 0.0);
    position += 200.0 * Eigen::Vector2d(std::sin(course), std::cos(course));
    Measurement measurement;
    measurement.time_s = k;
    measurement.z = position + 100.0 * Eigen::Vector2d(random.normal(), random.normal());
    log.push_back(measurement);
  }
  return log;
}

}  // namespace truebearing::testing
