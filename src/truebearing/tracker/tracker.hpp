// SPDX-License-Identifier: Apache-2.0
// Tracker: the run-time interface of every estimator in the house, one virtual call per measurement.
#pragma once

#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string_view>

#include "truebearing/measurement/measured.hpp"
#include "truebearing/measurement/measurement.hpp"
#include "truebearing/tracker/step_record.hpp"
#include "truebearing/tracker/tracker_pack.hpp"

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
  bool neighbour = false;          ///< of every record while another target is followed
  bool measures_position = false;  ///< the innovation's z is the position, the first half of the state
};

/// Something that a tracker noticed, beside its estimates.
struct TrackEvent {
  enum class Kind : unsigned char {
    range_known,     ///< the measurements determine the target's range from here on
    handed_over,     ///< a batch estimate began a filter
    given_up,        ///< that filter had no estimate any more; the batch begins anew
    source_changed,  ///< the target's frequency jumped; `value`: to so many Hz
    turn_began,      ///< the target left its course or speed
    turn_ended,
    track_began,  ///< of a target that appeared; `value`: the track's number
    track_ended   ///< of one that is not heard any more
  };
  Kind kind;
  double time_s;  ///< of the event itself, at or before the step that noticed it
  double value = std::numeric_limits<double>::quiet_NaN();
};

constexpr std::string_view to_string(TrackEvent::Kind kind) {
  switch (kind) {
    case TrackEvent::Kind::range_known:
      return "range_known";
    case TrackEvent::Kind::handed_over:
      return "handed_over";
    case TrackEvent::Kind::given_up:
      return "given_up";
    case TrackEvent::Kind::source_changed:
      return "source_changed";
    case TrackEvent::Kind::turn_began:
      return "turn_began";
    case TrackEvent::Kind::turn_ended:
      return "turn_ended";
    case TrackEvent::Kind::track_began:
      return "track_began";
    case TrackEvent::Kind::track_ended:
      return "track_ended";
  }
  return "unknown";
}

class Tracker {
 public:
  virtual ~Tracker() = default;

  /// Takes one measurement and returns one record per tracked target; none before a track exists. The records stay
  /// valid until the next call on this tracker. Does not throw on data and does not allocate after the first steps.
  virtual std::span<const StepRecord> step(const Measurement& measurement) = 0;

  /// All measurements of a run, after reset() and before the first step: for those that look back from its end, as
  /// smoothers do. Others hear nothing of it.
  virtual void foresee(std::span<const Measurement>) {}

  /// Back to the state after construction.
  virtual void reset() = 0;

  /// Becomes a copy of `other`, as it stands, which was made by fresh() from this one or from the same. False, and
  /// nothing done, where that cannot be.
  virtual bool assign(const Tracker&) { return false; }

  /// An independent tracker in the state after construction.
  virtual std::unique_ptr<Tracker> fresh() const = 0;

  /// What steps several trackers made by fresh() from this one or from the same together (tracker_pack.hpp); nothing
  /// where that costs no less than one after another.
  virtual std::unique_ptr<TrackerPack> pack() const { return nullptr; }

  /// The space of the records' states.
  virtual const StateSpace& space() const = 0;

  /// What it takes, so that a study that pairs it with a scenario of something else is refused when it is read; nothing
  /// where it does not say.
  virtual std::optional<Measured> measures() const { return std::nullopt; }

  /// Which blocks its records carry, so that what a feature needs is checked when a study is read.
  virtual RecordBlocks blocks() const { return {}; }

  virtual TrackerCounts counts() const { return {}; }

  /// What it noticed since reset(), in the order in which it did.
  virtual std::span<const TrackEvent> events() const { return {}; }

 protected:
  Tracker() = default;
  Tracker(const Tracker&) = default;
  Tracker& operator=(const Tracker&) = default;
};

}  // namespace truebearing
