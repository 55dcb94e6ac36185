// What an estimator can use of one interval's snapshots. A sensor that gives zeros or NaN throughout is dead and left
// out; of what is left, a snapshot with a value that is not finite is dropped.
#pragma once

#include <complex>
#include <vector>

#include "truebearing/measurement/snapshot_block.hpp"

namespace truebearing {

class Interval {
 public:
  /// Allocates where the array is larger than any before.
  void take(const SnapshotBlock& block);

  int sensors() const { return static_cast<int>(live_.size()); }
  /// 1 for a sensor that lives, 0 for one that is dead.
  const std::vector<double>& live() const { return live_; }
  int live_sensors() const { return live_count_; }
  /// Numbers in the block of the snapshots that can be used.
  const std::vector<int>& snapshots() const { return snapshots_; }
  /// Enough to be worth anything: a snapshot, and two sensors.
  bool is_usable() const { return !snapshots_.empty() && live_count_ >= 2; }
  /// The value of sensor m in snapshot t of the block; 0 of a dead sensor.
  std::complex<double> value(int t, int m) const {
    const std::size_t sensor = static_cast<std::size_t>(m);
    return live_[sensor] == 0.0 ? 0.0 : block_.snapshot(t)[sensor];
  }
  double spacing_wavelengths() const { return block_.spacing_wavelengths; }
  double interval_s() const { return block_.interval_s; }
  int block_snapshots() const { return block_.snapshots(); }

 private:
  SnapshotBlock block_;
  std::vector<double> live_;
  int live_count_ = 0;
  std::vector<int> snapshots_;
};

}  // namespace truebearing
