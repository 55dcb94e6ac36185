// SPDX-License-Identifier: Apache-2.0
// What an estimator can use of one interval's snapshots. A sensor that gives zeros or NaN throughout is dead and left
// out; of what is left, a snapshot with a value that is not finite is dropped. Real and imaginary parts are kept apart,
// snapshot by snapshot, padded with zeros to whole registers (simd_width.hpp).
#pragma once

#include <Eigen/Core>
#include <complex>
#include <vector>

#include "truebearing/core/simd_width.hpp"
#include "truebearing/measurement/snapshot_block.hpp"

namespace truebearing {

class Interval {
 public:
  /// Allocates where the block is larger than any before.
  void take(const SnapshotBlock& block);

  int sensors() const { return sensors_; }
  /// 1 for a sensor that lives, 0 for one that is dead (M).
  const std::vector<double>& live() const { return live_; }
  int live_sensors() const { return live_count_; }
  /// Usable snapshots; t counts them.
  int snapshots() const { return static_cast<int>(numbers_.size()); }
  /// Enough to be worth anything: a snapshot, and two sensors.
  bool is_usable() const { return !numbers_.empty() && live_count_ >= 2; }
  /// The parts of usable snapshot t (padded M); 0 of a dead sensor.
  const double* re(int t) const { return re_.col(t).data(); }
  const double* im(int t) const { return im_.col(t).data(); }
  std::complex<double> value(int t, int m) const { return {re_(m, t), im_(m, t)}; }

  /// Of all that came, usable or not: how many snapshots, and the number of usable one t among them.
  int block_snapshots() const { return block_snapshots_; }
  int number(int t) const { return numbers_[static_cast<std::size_t>(t)]; }
  double spacing_wavelengths() const { return spacing_wavelengths_; }
  double interval_s() const { return interval_s_; }
  /// Sums over the block by which two blocks can be told apart; NaN where a value is.
  const Eigen::Vector3d& sums() const { return sums_; }

 private:
  void take_part(const SnapshotBlock& block);

  int sensors_ = 0, live_count_ = 0, block_snapshots_ = 0;
  double spacing_wavelengths_ = 0.5, interval_s_ = 1.0;
  std::vector<double> live_;
  std::vector<int> numbers_;
  Eigen::MatrixXd re_, im_;                               // (padded M x Ns)
  Eigen::Matrix<double, Eigen::Dynamic, 3> sensor_sums_;  // of real parts, imaginary parts and powers (M)
  Eigen::Vector3d sums_ = Eigen::Vector3d::Zero();
};

}  // namespace truebearing
