// SPDX-License-Identifier: Apache-2.0
// Batch target-motion analysis as a Tracker: bearings, and frequencies where they are configured, are collected in a
// growing or sliding window, and the estimate is made afresh from all of them. Between solutions, and while nothing is
// measured, the last one is carried on at constant velocity (`coasted`). Where the geometry does not determine the
// range its records say `unobservable`.
//
// z = [bearing] or [bearing, frequency]; of two either may be missing. With frequencies the state has a fifth
// component, the f0 that the source has at the end of the window.
#pragma once

#include <limits>
#include <optional>
#include <variant>
#include <vector>

#include "truebearing/tma/target_motion_batch.hpp"
#include "truebearing/tma/cho_2015.hpp"
#include "truebearing/tma/frequency_changes.hpp"
#include "truebearing/tma/range_prior.hpp"
#include "truebearing/tracker/stream_guard.hpp"
#include "truebearing/tracker/tracker.hpp"

namespace truebearing {

/// The use of frequencies, not with Cho's methods. Own ship's velocity has to come with each.
struct BatchFrequencyOptions {
  double sigma_hz = 0.0;  ///< where a measurement carries none
  double sound_mps = kSoundInWater_mps;
  FrequencyChangeOptions changes;
};

struct BearingsBatchOptions {
  std::variant<TargetMotionBatchOptions, ChoOptions> method;
  /// Maximum a posteriori instead of maximum likelihood. Without a guess that it needs nothing is solved.
  std::optional<std::variant<RangePrior, VelocityPrior>> prior;
  double sigma_rad = 0.0;     ///< where a measurement carries none
  double sigma_factor = 1.0;  ///< of bearings and frequencies
  std::optional<BatchFrequencyOptions> frequency;
  double window_s = std::numeric_limits<double>::infinity();
  /// Solve at the first step at or after each of these; else every so many seconds, 0: at every step.
  std::vector<double> solve_at_s;
  double solve_every_s = 0.0;
  bool warm_start = false;  ///< from the solution before, besides the usual starts
  /// Look for a change of the target's velocity inside the window after each solution (residual_checks.hpp) that knows
  /// the range; where there is one, forget what was before it.
  bool cut_at_manoeuvres = false;
};

class BearingsBatchTracker final : public Tracker {
 public:
  explicit BearingsBatchTracker(BearingsBatchOptions options);

  std::span<const StepRecord> step(const Measurement& measurement) override;
  void reset() override;
  std::unique_ptr<Tracker> fresh() const override { return std::make_unique<BearingsBatchTracker>(options_); }
  const StateSpace& space() const override { return options_.frequency ? plane_frequency_space() : plane_space(); }
  std::optional<Measured> measures() const override {
    return options_.frequency ? Measured::bearing_frequency() : Measured::bearing();
  }
  TrackerCounts counts() const override { return guard_.counts; }

  /// The first range_known; of the source, source_changed; where the options cut at manoeuvres, turn_began.
  std::span<const TrackEvent> events() const override { return events_; }

  /// The last estimate that was found, at its own time.
  const BatchEstimate& estimate() const { return estimate_; }

 private:
  void believe(const Measurement& first, double sigma_rad, const SensorState& sensor);
  void add(const Measurement& measurement);
  bool has_frequency(const Measurement& measurement) const;
  bool is_due(double time_s);
  BatchEstimate solve();
  void take(const BatchEstimate& estimate);
  void cut_at_manoeuvre();
  void report_changes();

  BearingsBatchOptions options_;
  TargetMotionBatch solver_;
  FrequencyChangeBatch frequency_solver_;
  StreamGuard guard_;
  BearingWindow window_;
  DopplerWindow frequencies_;
  std::optional<TargetGuess> guess_;
  std::optional<BatchPrior> prior_;  // of the track, from its first bearing
  BatchEstimate estimate_;           // the last that was found
  SourceFrequency source_;           // at the end of its window
  bool range_known_ = false;
  std::vector<TrackEvent> events_;
  std::size_t solved_ = 0;  // of solve_at_s
  double due_s_ = -std::numeric_limits<double>::infinity();
  StepRecord record_;
};

}  // namespace truebearing
