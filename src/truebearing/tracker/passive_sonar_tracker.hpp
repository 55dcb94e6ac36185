// SPDX-License-Identifier: Apache-2.0
// What an operator of a passive sonar needs on one log of bearings and frequencies, as one Tracker (Kim and Song): a
// batch estimate is made until it knows the range well enough; a filter takes it over, carried to that time, and goes
// on from there, so that no measurement counts twice. Where the filter is given up, a batch begins anew. Along the way
// it reports as events when the range became known, when the filter took over, when it was given up, when the source
// changed its frequency and when the target turned.
#pragma once

#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "truebearing/tracker/bearing_frequency_sensor.hpp"
#include "truebearing/tracker/bearings_batch_tracker.hpp"
#include "truebearing/tracker/successor.hpp"

namespace truebearing {

struct PassiveSonarOptions {
  double hand_over_s = 0.0;  ///< not before this time; after a filter was given up, not before so much later
  /// Standard deviation of the range, in percent of it, from which on the batch estimate is good enough.
  double hand_over_percent = std::numeric_limits<double>::infinity();
  /// Two frequencies that follow each other differ by more than this many of their standard deviations by chance with
  /// the false-alarm probability that was asked for (equation 6).
  double gamma = 4.81123;
  /// And by as much as the target's radial velocity may change in between. Own ship's own part is known.
  double manoeuvre_mps = 1.0;
  /// While mode 1 of a multiple-model filter is less likely than this, the target turns.
  double steady_probability = 0.5;
  bool show_batch = true;  ///< false: no records before the filter has taken over
  /// For frequencies of a measurement that carries no standard deviation.
  BearingFrequencySensor sensor{};
};

class PassiveSonarTracker final : public Tracker {
 public:
  /// `filter` waits for its hand-over, and its state begins as the batch's does.
  PassiveSonarTracker(PassiveSonarOptions options, std::unique_ptr<Tracker> batch, std::unique_ptr<Successor> filter);

  std::span<const StepRecord> step(const Measurement& measurement) override;
  void reset() override;
  std::unique_ptr<Tracker> fresh() const override;
  const StateSpace& space() const override { return filter_->space(); }
  std::optional<Measured> measures() const override {
    return filter_->measures() ? filter_->measures() : batch_->measures();
  }
  RecordBlocks blocks() const override { return filter_->blocks(); }
  TrackerCounts counts() const override;
  std::span<const TrackEvent> events() const override { return events_; }

 private:
  std::span<const StepRecord> collect(const Measurement& measurement);
  std::span<const StepRecord> follow(const Measurement& measurement);
  std::span<const StepRecord> filtered(const Measurement& measurement);
  void give_up(double time_s);
  bool is_good_enough(const StepRecord& record) const;

  struct Heard {
    double time_s;
    double frequency_hz;  // of the source, had the target not manoeuvred since the last estimate
  };
  /// What a frequency says of the source, by those before it.
  enum class Source { steady, doubtful, changed };
  Source watch_source(const Measurement& measurement);
  std::optional<Heard> heard(const Measurement& measurement) const;
  void remember(const StepRecord& record);
  void notice_turn(const StepRecord& record);

  PassiveSonarOptions options_;
  std::unique_ptr<Tracker> batch_;
  std::unique_ptr<Successor> filter_;

  bool following_ = false;
  bool turning_ = false;
  std::vector<TrackEvent> events_;
  StepRecord record_;  // the batch's, in the space of the filter

  // Of a batch after a filter that was given up: its time 0, and what was before.
  double begun_s_ = 0.0;
  std::size_t events_before_ = 0;
  TrackerCounts counts_before_;

  std::optional<Heard> last_;      // the last frequency of the source as it is known
  std::optional<Heard> doubtful_;  // one that differs from it, until the next one tells
  GaussianState plane_{};          // the last estimate
  double plane_s_ = 0.0;           // of that time
};

}  // namespace truebearing
