// SPDX-License-Identifier: Apache-2.0
// Trackers, measurements and logs on a line: the small cast that the tests of several rooms share.
#pragma once

#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "truebearing/core/constants.hpp"
#include "truebearing/core/random.hpp"
#include "truebearing/core/state_space.hpp"
#include "truebearing/filter/kalman.hpp"
#include "truebearing/motion/constant_velocity.hpp"
#include "truebearing/simulation/line_scenario.hpp"
#include "truebearing/tracker/filter_bank.hpp"
#include "truebearing/tracker/filter_tracker_of.hpp"
#include "truebearing/tracker/position_sensor.hpp"

namespace truebearing::testing {

using RadarMotion = ConstantVelocity<1, FixedNoise<2>>;
using RadarTracker = FilterTrackerOf<KalmanFilter<2>, RadarMotion, PositionSensor<1>>;

/// The filter of the 1-D radar studies, number by number.
struct RadarFilter {
  Eigen::Vector2d x0 = Eigen::Vector2d::Zero();
  Eigen::Vector2d variance{999.0, 999.0};
  Eigen::Vector2d noise_variance{5.0, 0.1};
  double sigma_m = std::sqrt(1e7);
  FilterTrackerOptions options = {};

  RadarMotion motion() const { return {{noise_variance.asDiagonal(), 1.0}}; }
  KalmanFilter<2> filter() const { return {x0, variance.asDiagonal()}; }
  PositionSensor<1> sensor() const { return {Eigen::Matrix<double, 1, 1>(sigma_m), 1.0}; }
  std::unique_ptr<RadarTracker> tracker() const {
    return std::make_unique<RadarTracker>(line_space(), motion(), sensor(),
                                          PriorStart{x0, variance.asDiagonal().toDenseMatrix(), 0.0}, options);
  }
};

/// A bank of such filters, one for each and with the weights given, or all alike.
inline std::unique_ptr<FilterBank> radar_bank(const std::vector<RadarFilter>& hypotheses,
                                              const std::vector<double>& log_weights = {}) {
  std::vector<std::shared_ptr<const SizedMotion<2>>> motions;
  std::vector<FilterGroup::Member> members;
  std::vector<std::unique_ptr<AnySensor>> sensors;
  std::vector<FilterBank::Hypothesis> priors;
  for (const RadarFilter& radar : hypotheses) {
    const std::size_t i = priors.size();
    motions.push_back(erased(radar.motion()));
    members.push_back({i, i});
    sensors.push_back(sensor_of(radar.sensor()));
    priors.push_back(
        {radar.x0, radar.variance.asDiagonal().toDenseMatrix(), log_weights.empty() ? 0.0 : log_weights[i]});
  }
  return std::make_unique<FilterBank>(
      line_space(), std::make_unique<FilterGroupOf<KalmanFilter<2>>>(std::move(motions), std::move(members)),
      std::move(sensors), std::move(priors));
}

inline Measurement position(double time_s, double z_m) {
  return {.time_s = time_s, .z = BoundedVector::Constant(1, z_m), .sigma = {}, .sensor = {}};
}

/// A target drawn from the 1-D radar family, measured every second.
inline LineScenario radar_family(int steps) {
  LineParameters parameters;
  parameters.steps = steps;
  parameters.position_m = Distribution(Distribution::Kind::normal, {0.0, 1000.0});
  parameters.velocity_mps = Distribution(Distribution::Kind::uniform, {-400.0, 400.0});
  parameters.process_noise_variance = {5.0, 0.1};
  parameters.process_noise_scale = Distribution(Distribution::Kind::log_uniform, {0.25, 4.0});
  parameters.noise = Distribution(Distribution::Kind::log_uniform, {2.5e6, 4e7});
  parameters.noise_is_variance = true;
  return LineScenario(parameters);
}

inline std::vector<Measurement> radar_log(std::uint64_t run, int steps) {
  return radar_family(steps).simulate({.seed = 7, .role = Role::evaluation, .run = run}).measurements;
}

/// The record of a tracker of one target after all of these measurements.
inline StepRecord last_record(Tracker& tracker, const std::vector<Measurement>& measurements) {
  StepRecord last;
  for (const Measurement& measurement : measurements)
    if (const auto records = tracker.step(measurement); !records.empty()) last = records.front();
  return last;
}

}  // namespace truebearing::testing
