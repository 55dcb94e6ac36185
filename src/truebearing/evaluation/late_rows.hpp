// SPDX-License-Identifier: Apache-2.0
// Measurements that come late, as packets do: exact by running again. The last `keep_s` seconds of measurements are kept
// with checkpoints of the trackers on the way; a late one is put where it belongs, and all that come after it are taken
// once more. What the trackers then are is what the log in order of its times would have made of them, to the bit.
#pragma once

#include <cstddef>
#include <functional>
#include <list>
#include <vector>

#include "truebearing/evaluation/tracker_set.hpp"

namespace truebearing {

class LateRows {
 public:
  /// Called after each step of the trackers, the first time and again (`revised`).
  using Publish = std::function<void(const Measurement& measurement, bool revised)>;

  /// keep_s: > 0; how late a measurement may be. Throws InputError where a tracker cannot be run again
  /// (Tracker::assign()).
  LateRows(const TrackerSet& trackers, double keep_s);

  /// One that is later than keep_s is counted and does nothing: false.
  bool step(TrackerSet& trackers, const Measurement& measurement, const Publish& publish);

  std::size_t taken() const { return taken_; }        ///< late ones that were put where they belong
  std::size_t too_late() const { return too_late_; }  ///< that were not
  std::size_t again() const { return again_; }        ///< steps that were run again for them

 private:
  struct Checkpoint {
    TrackerSet trackers;
    std::size_t next;  ///< number of the first measurement that they have not taken
    double time_s;     ///< of that one
  };

  void run(TrackerSet& trackers, std::size_t number, const Publish& publish, bool revised);
  void forget(double before_s);
  void insert(std::size_t number, const Measurement& measurement);
  Measurement& kept(std::size_t number) { return ring_[number & (ring_.size() - 1)]; }

  double keep_s_;
  std::vector<Measurement> ring_;              // a power of two; by time, number k at k modulo that
  std::size_t first_ = 0, end_ = 0;            // numbers of those that are kept
  std::list<Checkpoint> checkpoints_, spare_;  // by time; those that are no longer needed
  std::size_t taken_ = 0, too_late_ = 0, again_ = 0;
};

}  // namespace truebearing
