// SPDX-License-Identifier: Apache-2.0
// What is timed (plane_bench.cpp) and counted (kernel_counts.cpp) in the plane: a turning target, seen once a second, and the
// models, trackers and the correction that follow it.
#pragma once

#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "truebearing/core/random.hpp"
#include "truebearing/correction/corrected_tracker.hpp"
#include "truebearing/filter/interacting_multiple_model.hpp"
#include "truebearing/filter/kalman.hpp"
#include "truebearing/filter/unscented.hpp"
#include "truebearing/measurement/longer_state.hpp"
#include "truebearing/measurement/position.hpp"
#include "truebearing/measurement/range_bearing.hpp"
#include "truebearing/motion/constant_acceleration.hpp"
#include "truebearing/motion/constant_velocity.hpp"
#include "truebearing/motion/coordinated_turn.hpp"
#include "truebearing/motion/singer.hpp"
#include "truebearing/motion/turning_target.hpp"
#include "truebearing/tracker/filter_tracker_of.hpp"
#include "truebearing/tracker/position_sensor.hpp"

namespace truebearing::bench {

inline constexpr int kSteps = 1000;
inline constexpr double kSigma_m = 100.0;

inline std::vector<Eigen::Vector2d> positions() {
  std::vector<Eigen::Vector2d> z;
  RandomStream random({}, StreamId::test);
  Eigen::Vector2d position(5000.0, 20000.0);
  for (int k = 0; k < kSteps; ++k) {
    const double course = 0.7 * std::sin(0.01 * k);
    position += 200.0 * Eigen::Vector2d(std::sin(course), std::cos(course));
    z.push_back(position + kSigma_m * Eigen::Vector2d(random.normal(), random.normal()));
  }
  return z;
}

inline Eigen::Vector2d polar(const Eigen::Vector2d& position) {
  return {position.norm(), std::atan2(position.x(), position.y())};
}

using Cv = ConstantVelocity<2, DiscreteWhiteNoise>;
using Ct = CoordinatedTurn<DiscreteWhiteNoise>;
inline const Position<2> kPosition{{kSigma_m, kSigma_m}};
inline const RangeBearing<> kPolar{{0.0, 0.0}, 50.0, 0.005};
inline const Cv kCv{{8.0}};
inline const Ct kCt{{2.0}, 0.03};
inline const ConstantAcceleration<2> kCa{{4.0}};
inline const Singer<2> kSinger{10.0, 20.0};
inline const TurningTarget<DiscreteWhiteNoise> kTurning{{2.0}, 0.01};

inline std::unique_ptr<TrackedState> six_models() {
  InteractingMultipleModel::Modes modes;
  modes.push_back(state_of<KalmanFilter<4>>(Cv{{0.55}}));
  for (const double rate_degps : {-5.0, -2.0, 2.0, 5.0})
    modes.push_back(state_of<KalmanFilter<4>>(Ct{{2.1}, rate_degps * 0.0174533}));
  modes.push_back(state_of<KalmanFilter<4>>(Cv{{22.5}}));
  return std::make_unique<InteractingMultipleModel>(std::move(modes), star_chain(6, 0.037, 0.084, 0.7, 1.0));
}

using CvTracker = FilterTrackerOf<KalmanFilter<4>, Cv, PositionSensor<2>>;

inline std::unique_ptr<Tracker> cv_tracker(double sigma_a) {
  return std::make_unique<CvTracker>(plane_space(), Cv{{sigma_a}}, PositionSensor<2>{{kSigma_m, kSigma_m}, 1.0},
                                     TwoPointStart{});
}

inline Ensemble ensemble() {
  Ensemble members;
  members.add("plain", cv_tracker(8.0));
  members.add("tuned", cv_tracker(20.0));
  return members;
}

// The features of data/studies/manoeuvre_2d.toml, with a network of its size.
inline CorrectionModel model(int rules) {
  CorrectionModel model;
  model.space = &plane_space();
  model.design.base = model.design.covariance_of = "plain";
  model.design.reference = "tuned";
  model.design.covariance_moments = true;
  model.design.frame = Frame::track;
  for (const double alpha : {0.0, 0.5, 0.2, 0.08})
    for (const char* component : {"along_m", "cross_m"})
      model.design.features.push_back({.kind = alpha > 0.0 ? FeatureKind::innovation_average : FeatureKind::innovation,
                                       .component = component,
                                       .companion = {},
                                       .alpha = alpha});
  const auto d = static_cast<Eigen::Index>(model.design.features.size());
  const auto spread = [](Eigen::Index rows, Eigen::Index cols, double size) {
    Eigen::MatrixXd values(rows, cols);
    for (Eigen::Index i = 0; i < values.size(); ++i) values(i) = size * std::sin(12.9898 * static_cast<double>(i + 1));
    return values;
  };
  model.rules().network = FuzzyNetwork({.input_mean = Eigen::VectorXd::Zero(d),
                                        .input_scale = Eigen::VectorXd::Ones(d),
                                        .centres = spread(rules, d, 2.0),
                                        .widths = Eigen::MatrixXd::Constant(rules, d, 1.5),
                                        .consequents = spread(rules, 4, 1.0),
                                        .output_scale = Eigen::Vector4d(80.0, 80.0, 40.0, 40.0)});
  model.gate = BoxGate{Eigen::VectorXd::Constant(d, -20.0), Eigen::VectorXd::Constant(d, 20.0)};
  model.rules().moments = Eigen::MatrixXd::Zero(rules, 16);
  for (Eigen::Index j = 0; j < rules; ++j)
    model.rules().moments.row(j) = Eigen::Matrix4d::Identity().reshaped().transpose();
  model.rules().usage = Eigen::VectorXd::Constant(rules, 1.0 / rules);
  model.rules().local_mean = Eigen::MatrixXd::Zero(rules, 4);
  return model;
}

// The positions as a stream of measurements, one a second.
inline std::vector<Measurement> stream() {
  std::vector<Measurement> measurements;
  for (const Eigen::Vector2d& z : positions()) {
    Measurement measurement;
    measurement.time_s = static_cast<double>(measurements.size() + 1);
    measurement.z = z;
    measurements.push_back(measurement);
  }
  return measurements;
}

}  // namespace truebearing::bench
