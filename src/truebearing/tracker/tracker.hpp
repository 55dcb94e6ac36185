// Tracker: the run-time interface of every estimator in the house, one virtual call per measurement.
#pragma once

#include <memory>
#include <span>

#include "truebearing/measurement/measurement.hpp"
#include "truebearing/tracker/step_record.hpp"

namespace truebearing {

/// What a tracker met that was not a plain measurement, counted since reset().
struct TrackerCounts {
  int missing = 0;       ///< NaN or empty measurements
  int repeated = 0;      ///< identical to the measurement before, not used again
  int out_of_order = 0;  ///< earlier than the state, not used
  int gated = 0;         ///< outside the gate, not used
  int failed = 0;        ///< the arithmetic said `failed`
};

/// The optional blocks that a tracker fills in the records of steps in which it used the measurement.
struct RecordBlocks {
  bool prediction = false;
  bool innovation = false;
  bool gain = false;
  bool mode_probabilities = false;
  bool measures_position = false;  ///< the innovation's z is the position, the first half of the state
};

class Tracker {
 public:
  virtual ~Tracker() = default;

  /// Takes one measurement and returns one record per tracked target; none before a track exists. The records stay
  /// valid until the next call on this tracker. Does not throw on data and does not allocate after the first steps.
  virtual std::span<const StepRecord> step(const Measurement& measurement) = 0;

  /// Back to the state after construction.
  virtual void reset() = 0;

  /// An independent tracker in the state after construction.
  virtual std::unique_ptr<Tracker> clone() const = 0;

  /// The space of the records' states.
  virtual const StateSpace& space() const = 0;

  /// Which blocks its records carry, so that what a feature needs is checked when a study is read.
  virtual RecordBlocks blocks() const { return {}; }

  virtual TrackerCounts counts() const { return {}; }

 protected:
  Tracker() = default;
  Tracker(const Tracker&) = default;
  Tracker& operator=(const Tracker&) = default;
};

}  // namespace truebearing
