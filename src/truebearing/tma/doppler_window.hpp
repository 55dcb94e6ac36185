// SPDX-License-Identifier: Apache-2.0
// The frequencies that a batch estimate is made from, beside its bearings: tones of a source at f0, shifted by
// Doppler's effect on the way to a sensor that moves,
//
//     f = f0 (1 - v_r / c),  v_r = (v - v_site) . u,  u the line of sight
//
// (measurement/bearing_frequency.hpp). A source may change its tone: every frequency belongs to a level, and each level
// has an f0 of its own. The f0s enter linearly, so that the best of them for a state is known in closed form.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "truebearing/measurement/bearing_frequency.hpp"
#include "truebearing/measurement/measurement.hpp"

namespace truebearing {

/// The f0 of one level, as a function of the state x = [east, north, v_east, v_north].
struct SourceFrequency {
  double frequency_hz = 0.0;                                  ///< the best for x
  double variance = 0.0;                                      ///< of its error where x is exact, Hz^2
  Eigen::RowVector4d per_state = Eigen::RowVector4d::Zero();  ///< d frequency_hz / dx

  /// Of its error where that of x has covariance P.
  double variance_with(const Eigen::Matrix4d& P) const { return variance + per_state * P * per_state.transpose(); }
};

/// Covariance of [x, f0] for the covariance P of x: the inverse of the information on both. Positive semi-definite.
Eigen::Matrix<double, 5, 5> covariance_with(const Eigen::Matrix4d& P, const SourceFrequency& source);

class DopplerWindow {
 public:
  explicit DopplerWindow(double sound_mps = kSoundInWater_mps) : sound_mps_(sound_mps) {}

  /// Appends one frequency, of the level of the one before; times do not decrease. sigma_hz > 0.
  void add(double time_s, double frequency_hz, double sigma_hz, const SensorState& sensor);
  /// Drops what is older than `time_s`, and levels that are then empty.
  void drop_before(double time_s);
  void clear();
  void reserve(std::size_t count);

  std::size_t size() const { return time_s_.size(); }
  double sound_mps() const { return sound_mps_; }
  double time_s(std::size_t i) const { return time_s_[i]; }
  double frequency_hz(std::size_t i) const { return frequency_hz_[i]; }
  double sigma_hz(std::size_t i) const { return sigma_hz_[i]; }
  double weight(std::size_t i) const { return 1.0 / (sigma_hz_[i] * sigma_hz_[i]); }
  const SensorState& sensor(std::size_t i) const { return sensor_[i]; }

  /// The level of each frequency, 0 to levels() - 1, none of them empty; one for all to begin with.
  int level(std::size_t i) const { return level_[i]; }
  int levels() const { return levels_; }
  /// One number for each frequency. They are renumbered in the order in which they come.
  void set_levels(std::span<const int> level);

  /// 1 - v_r / c at frequency i, and its derivative by x, for x at time origin_s.
  struct Shift {
    double value;
    Eigen::RowVector4d per_state;
  };
  Shift shift(std::size_t i, const Eigen::Vector4d& x, double origin_s) const;
  /// The f0 of one level for x at time origin_s.
  SourceFrequency source(int level, const Eigen::Vector4d& x, double origin_s) const;
  /// Those of all levels.
  void sources(const Eigen::Vector4d& x, double origin_s, std::vector<SourceFrequency>& sources) const;

 private:
  void renumber();

  double sound_mps_;
  std::vector<double> time_s_, frequency_hz_, sigma_hz_;
  std::vector<SensorState> sensor_;
  std::vector<int> level_, number_;  // number_: scratch of renumber()
  int levels_ = 0;
};

}  // namespace truebearing
