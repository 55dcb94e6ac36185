// SPDX-License-Identifier: Apache-2.0
// The joint filter of all targets' angles (array/joint_angle_filter.hpp) with its hypotheses as a Tracker: one record
// per target. It begins with the first usable interval: angles from its covariance, rates unknown. Where targets may
// appear and vanish, a signal that the others do not explain begins a track, at once or when it is heard again, and a
// track whose signal is not heard any more ends.
//
// The innovation in the records is the equivalent one: that of a measurement of the angle by itself which would have
// changed estimate and variance as the whole interval did.
#pragma once

#include <optional>
#include <variant>
#include <vector>

#include "truebearing/array/angle_hypotheses.hpp"
#include "truebearing/array/line_array.hpp"
#include "truebearing/array/sample_covariance.hpp"
#include "truebearing/tracker/angle_records.hpp"
#include "truebearing/tracker/stream_guard.hpp"
#include "truebearing/tracker/tracker.hpp"

namespace truebearing {

struct JointAngleOptions {
  /// How many targets there are, or how that is found in the first interval; what begins later is beside it.
  std::variant<int, OrderCriterion> targets = 1;
  AngleHypotheses::Options hypotheses;
  double rate_sigma_radps = 0.035;  ///< of what is believed of a new target's rate, which is 0
  /// Targets move inside an interval: it is cut into so many blocks, and its scores belong to its middle. 0: they stand
  /// still, where they are at its end.
  int moving_blocks = 0;
  /// Of a sensor; where it is not given it is estimated.
  std::optional<double> noise_power;
  double noise_alpha = 0.05;  ///< weight of an interval in that estimate
  /// Targets appear and vanish. Presences are twice a gain of the log likelihood: what noise alone gives stays below a
  /// dozen, a target as loud as noise has hundreds. Of quiet ones a track is kept by more misses, at more false tracks.
  struct Lifetimes {
    double begin_presence = 30.0;
    int begin_hits = 1;  ///< of the last three intervals; 3 for one heard close to a track
    double end_presence = 15.0;
    int end_misses = 1;    ///< in a row
    int close_misses = 4;  ///< so many more for a target that stands close to another
  };
  std::optional<Lifetimes> lifetimes;
};

class JointAngleTracker final : public Tracker {
 public:
  explicit JointAngleTracker(JointAngleOptions options);

  std::span<const StepRecord> step(const Measurement& measurement) override;
  void reset() override;
  std::unique_ptr<Tracker> fresh() const override { return std::make_unique<JointAngleTracker>(options_); }
  const StateSpace& space() const override { return angle_space(); }
  std::optional<Measured> measures() const override { return Measured::snapshots(fewest_sensors(options_.targets)); }
  RecordBlocks blocks() const override {
    return {.prediction = true, .innovation = true, .gain = true, .neighbour = true};
  }
  TrackerCounts counts() const override { return guard_.counts; }
  std::span<const TrackEvent> events() const override { return events_; }

  /// How many hypotheses are followed.
  int hypotheses() const { return started_ ? hypotheses_.count() : 0; }

 private:
  struct Track {
    int number;
    double presence = 0.0;
    int misses = 0;
  };
  struct Candidate {
    AngleLikelihood::Newcomer heard;
    int hits = 1, age = 0;
  };

  std::span<const StepRecord> begin_afresh(const Measurement& measurement);
  bool is_lost(double dt_s) const;
  bool begin(double time_s);
  std::optional<JointAngleState> state_from(const std::vector<double>& angles, const Eigen::MatrixXcd& R,
                                            double& log_likelihood);
  void follow_noise();
  void end_tracks(double time_s);
  void begin_tracks(double time_s);
  void add_target(const AngleLikelihood::Newcomer& heard, double time_s);
  std::span<const StepRecord> publish(const Measurement& measurement, StepStatus status);

  JointAngleOptions options_;
  StreamGuard guard_;
  Interval interval_;
  RealInterval real_;
  AngleHypotheses hypotheses_;
  bool started_ = false;
  double used_time_s_ = 0.0;  // of the last interval that was used
  double noise_power_ = 1.0;
  std::vector<Track> tracks_;
  int next_track_ = 0;
  std::vector<Candidate> candidates_;
  std::vector<double> grid_rad_;
  std::vector<StepRecord> records_;
  std::vector<TrackEvent> events_;
};

}  // namespace truebearing
