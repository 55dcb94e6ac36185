// SPDX-License-Identifier: Apache-2.0
// One measurement as it comes from a sensor or a log: a small vector with its time, its own standard deviations where
// the sensor gives them, and where the sensor was.
#pragma once

#include <Eigen/Core>
#include <limits>
#include <optional>

#include "truebearing/core/bounded.hpp"
#include "truebearing/measurement/snapshot_block.hpp"

namespace truebearing {

struct StepRecord;

struct SensorState {
  Eigen::Vector2d position_m = Eigen::Vector2d::Zero();  ///< East, North
  Eigen::Vector2d velocity_mps = Eigen::Vector2d::Zero();
  double up_m = 0.0;  ///< of targets in three dimensions; NaN where it is not told
  double climb_mps = 0.0;
};

/// What is believed of a target beforehand: an operator's guess as it is first heard.
struct TargetGuess {
  double range_m = 0.0;  ///< from the sensor
  double range_sigma_m = 0.0;
  double speed_mps = std::numeric_limits<double>::quiet_NaN();  ///< NaN where nothing is believed of it
  double speed_sigma_mps = std::numeric_limits<double>::quiet_NaN();
};

struct Measurement {
  double time_s = 0.0;
  BoundedVector z;      ///< in the units of the measured columns, angles in radians; NaN where a value is missing
  BoundedVector sigma;  ///< standard deviations of z, or empty where the tracker's own apply
  std::optional<SensorState> sensor;
  int source = 0;  ///< which sensor took it, by its place among those of the study; 0 where there is one
  std::optional<TargetGuess> guess{};
  /// What a tracker that ran elsewhere made of this measurement, where a step log tells; owned by the Recording.
  const StepRecord* recorded = nullptr;
  /// Of a line array, which has no z; the values are owned by the Recording.
  std::optional<SnapshotBlock> snapshots{};

  /// True where z lacks a value: all of it, but for sensors that can do with a part (bearing_frequency_sensor.hpp).
  bool is_missing() const { return z.size() == 0 || !z.allFinite(); }
};

}  // namespace truebearing
