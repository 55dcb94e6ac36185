// SPDX-License-Identifier: Apache-2.0
// FilterTracker makes a Tracker of a tracked state (filter/tracked_state.hpp) and a sensor. What the filter leaves open
// is decided here: missing, repeated, late and gated measurements, starts, long gaps, failed arithmetic, publishing.
#pragma once

#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "truebearing/filter/state_pack.hpp"
#include "truebearing/filter/tracked_state.hpp"
#include "truebearing/tracker/any_sensor.hpp"
#include "truebearing/tracker/gate.hpp"
#include "truebearing/tracker/start.hpp"
#include "truebearing/tracker/stream_guard.hpp"
#include "truebearing/tracker/successor.hpp"
#include "truebearing/tracker/tracker.hpp"

namespace truebearing {

struct FilterTrackerOptions {
  double gate_nis = std::numeric_limits<double>::infinity();  ///< see Gate
  /// Without a usable measurement for longer than this, the target is lost: its covariance stops growing, and
  /// the next usable measurement starts a new track.
  double lost_after_s = std::numeric_limits<double>::infinity();
  /// Jitter-aware output, in [0, 1]: the published position is moved by this share of the way to the measurement,
  /// x + beta (z - x), for truth that follows what was recorded rather than what was flown. The filter itself goes on
  /// without it. Of measured positions only.
  double output_pull = 0.0;
  /// What is published is where the target will be in so many seconds; the filter itself goes on without that. Not with
  /// output_pull.
  double ahead_s = 0.0;
  /// In place of gate_nis, of each of several sensors; else empty.
  std::vector<double> gate_nis_of{};
};

/// A state of more components than `space` has is published without the last of them.
class FilterTracker : public Successor {
 public:
  /// How the last step came by the state, for those who look back.
  struct Passage {
    bool used = false;     ///< the state is that after this step's measurement
    bool begins = false;   ///< it goes on from no state before: a track began, began anew, or another took over
    double widened = 1.0;  ///< factor on P_pred by which the gate let the measurement pass
  };

  /// A PriorStart has as many components as the state. Throws std::invalid_argument where the parts do not fit: a start
  /// that the sensor cannot tell, an output_pull without measured positions or ahead of time, a state shorter than its
  /// space or than what the sensor looks at.
  FilterTracker(const StateSpace& space, std::unique_ptr<TrackedState> state, std::unique_ptr<AnySensor> sensor,
                Start start, FilterTrackerOptions options = {});

  std::span<const StepRecord> step(const Measurement& measurement) override;
  void reset() override;
  void take_over(double time_s, const BoundedVector& x, const BoundedMatrix& P) override;
  bool is_lost() const override { return lost_ || !begun_; }
  std::unique_ptr<Tracker> fresh() const override;
  bool assign(const Tracker& other) override;
  std::unique_ptr<TrackerPack> pack() const override;

  const StateSpace& space() const override { return *space_; }
  std::optional<Measured> measures() const override { return sensor_->measured(); }
  RecordBlocks blocks() const override;
  TrackerCounts counts() const override { return guard_.counts; }

  /// At the last used measurement, or as the track began; means nothing where is_lost(). Not at the same time as
  /// another call, though const: the state may have to be fetched from a pack.
  const TrackedState& state() const {
    fetch_state();
    return *state_;
  }
  double used_time_s() const { return used_time_s_; }
  const Passage& passage() const { return passage_; }
  const FilterTrackerOptions& options() const { return options_; }

 private:
  friend class FilterTrackerPack;

  void check() const;
  void begin(const PriorStart& start);
  void restart(double time_s);
  void forget();
  void forget_challenger();
  std::optional<std::span<const StepRecord>> open(const Measurement& measurement);
  std::span<const StepRecord> go_on(const Measurement& measurement);
  void begin_record(const Measurement& measurement);
  std::span<const StepRecord> start_from(const Measurement& measurement);
  std::optional<PriorStart> start_at(const std::optional<Measurement>& waiting, const Measurement& measurement);
  void add_motion(double dt_s, PriorStart& start);
  Gate& gate_of(const Measurement& measurement);
  bool challenge(const Measurement& measurement, double nis);
  static void widen(TrackedState& state, double factor);
  std::span<const StepRecord> give_up();
  StepStatus cross(double dt_s, TrackedState& state) const;
  bool predict(double dt_s);
  StepStatus update(const Measurement& measurement);
  std::span<const StepRecord> refuse();
  void clear_blocks();

  // What is published (filter_tracker_publishing.cpp).
  using Copy = bool (*)(const double* from_x, const double* from_P, int n, BoundedVector& x, BoundedMatrix& P);
  static Copy copy_of(int states, int published);
  bool publish();
  void publish_ahead();
  void publish_pulled();
  bool copy_published(const TrackedState& state, BoundedVector& x, BoundedMatrix& P) const;
  void copy_published(const StatePack& pack, int lane, BoundedVector& x, BoundedMatrix& P) const;
  void pull(const AnyMeasurement& taken);

  // Of a step in a pack (filter_tracker_pack.cpp).
  bool is_ordinary(const Measurement& measurement) const;
  bool settle(const StatePack& pack, int lane, const Measurement& measurement, const AnyMeasurement& taken);
  void fetch_state() const;

  const StateSpace* space_;
  std::unique_ptr<AnySensor> sensor_;
  Start start_;
  FilterTrackerOptions options_;

  StreamGuard guard_;
  std::vector<Gate> gates_;  // of each sensor
  bool begun_ = false;
  // At the last measurement that was used, between steps. Within one the state goes on, and what it was is kept.
  std::unique_ptr<TrackedState> state_;
  std::unique_ptr<TrackedState> kept_;
  int published_;                        // components: those that the space has
  Copy copy_;                            // of them, with states of that length
  std::unique_ptr<TrackedState> ahead_;  // of state_ after ahead_s, for publishing
  // Where the state is held in state_'s place, while several trackers are stepped together.
  mutable PlaceInPack place_;
  bool usable_ = false;  // the measurement of this step
  double used_time_s_ = 0.0;
  Passage passage_;
  bool lost_ = false;      // the next usable measurement begins a new track
  int failed_in_row_ = 0;  // updates
  // A second hypothesis: the track that the measurements which the gate turned away would make.
  std::unique_ptr<TrackedState> challenger_;
  double challenger_time_s_ = 0.0;
  int agreeing_ = 0;                        // of those measurements, one after another; 0: no challenger
  std::optional<Measurement> turned_away_;  // the last of them
  std::optional<Measurement> pending_;      // the first of two positions
  std::optional<TargetGuess> guess_;        // the latest since reset, of a tracker of bearings
  StepRecord record_;
  // Of the last step's output_pull.
  BoundedVector moved_;
  BoundedMatrix spread_;
};

}  // namespace truebearing
