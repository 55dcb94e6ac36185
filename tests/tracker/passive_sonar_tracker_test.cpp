// SPDX-License-Identifier: Apache-2.0
#include "truebearing/tracker/passive_sonar_tracker.hpp"

#include <gtest/gtest.h>

#include "tests/support/fakes.hpp"
#include "tests/support/frequency_runs.hpp"
#include "truebearing/core/constants.hpp"
#include "truebearing/filter/filter_kinds.hpp"
#include "truebearing/filter/interacting_multiple_model.hpp"
#include "truebearing/filter/kalman.hpp"
#include "truebearing/tracker/filter_tracker.hpp"

namespace truebearing::passive_sonar_tracker_test {
namespace {

using testing::frequency_run;
using testing::FrequencyMotion;
using testing::kFrequencySensor;
using Kind = TrackEvent::Kind;

constexpr double kHandOver_s = 320.0;

// Stands in for a batch estimator: says the truth, known to 100 m, 0.1 m/s and 10 mHz, from `known_s` on.
testing::FakeTracker oracle_of(const Recording& recording, double known_s) {
  const Eigen::Vector<double, 5> variances(1e4, 1e4, 1e-2, 1e-2, 1e-4);
  const auto say = [=](const Measurement& measurement, std::size_t, testing::FakeTracker::Said& said) {
    std::size_t now = 0;
    while (recording.measurements[now].z[0] != measurement.z[0]) ++now;  // whatever its clock says
    said.records.push_back(
        testing::fake_record(plane_frequency_space(), measurement, recording.truth[0].x[now], variances.asDiagonal()));
    said.records.back().sensor = measurement.sensor;
    said.records.back().status = measurement.time_s >= known_s ? StepStatus::ok : StepStatus::unobservable;
  };
  return {plane_frequency_space(), say};
}

std::unique_ptr<TrackedState> two_levels() {
  InteractingMultipleModel::Modes modes;
  for (const double q_m2ps3 : {1e-9, 1e-2}) modes.push_back(state_of<KalmanFilter<5>>(FrequencyMotion{{{q_m2ps3}}}));
  MarkovChain chain = star_chain(2, 0.002, 0.05, 1.0, 8.0);
  chain.initial = Eigen::Vector2d(0.99, 0.01);
  return std::make_unique<InteractingMultipleModel>(std::move(modes), chain);
}

PassiveSonarTracker sonar(const Recording& recording, PassiveSonarOptions options = {},
                          const StateSpace& space = plane_frequency_space(), double known_s = 0.0,
                          FilterTrackerOptions filter = {}) {
  options.hand_over_s = kHandOver_s;
  options.sensor = kFrequencySensor;
  return {options, std::make_unique<testing::FakeTracker>(oracle_of(recording, known_s)),
          std::make_unique<FilterTracker>(space, two_levels(), sensor_of(kFrequencySensor), HandOverStart{}, filter)};
}

std::vector<Kind> kinds(const Tracker& tracker) {
  std::vector<Kind> all;
  for (const TrackEvent& event : tracker.events()) all.push_back(event.kind);
  return all;
}

double last_frequency_error_hz(Tracker& tracker, const Recording& recording) {
  double error = std::nan("");
  for (std::size_t k = 0; k < recording.measurements.size(); ++k) {
    const auto records = tracker.step(recording.measurements[k]);
    if (!records.empty()) error = records[0].x[4] - recording.truth[0].x[k][4];
  }
  return error;
}

TEST(PassiveSonarTracker, HandsOverAtItsTimeAndGoesOnFromThere) {
  const Recording recording = frequency_run(1);
  PassiveSonarTracker tracker = sonar(recording);
  testing::FakeTracker oracle = oracle_of(recording, 0.0);
  for (const Measurement& measurement : recording.measurements) {
    const auto records = tracker.step(measurement);
    ASSERT_EQ(records.size(), 1u);
    const auto batch = oracle.step(measurement);
    EXPECT_EQ(records[0].x == batch[0].x, measurement.time_s <= kHandOver_s);
    EXPECT_EQ(records[0].mode_probabilities.has_value(), measurement.time_s > kHandOver_s);
  }
  ASSERT_EQ(kinds(tracker), (std::vector{Kind::handed_over}));
  EXPECT_EQ(tracker.events()[0].time_s, kHandOver_s);
}

TEST(PassiveSonarTracker, WaitsUntilTheRangeIsKnownWellEnough) {
  const Recording recording = frequency_run(1);
  PassiveSonarTracker late = sonar(recording, {}, plane_frequency_space(), 500.0);
  PassiveSonarTracker never = sonar(recording, {.hand_over_percent = 0.1});
  for (const Measurement& measurement : recording.measurements) {
    late.step(measurement);
    never.step(measurement);
  }
  ASSERT_EQ(kinds(late), (std::vector{Kind::handed_over}));
  EXPECT_EQ(late.events()[0].time_s, 504.0);
  EXPECT_TRUE(never.events().empty());
}

TEST(PassiveSonarTracker, MayHideItsBatchAndItsFrequency) {
  const Recording recording = frequency_run(1);
  PassiveSonarTracker tracker = sonar(recording, {.show_batch = false}, plane_space());
  for (const Measurement& measurement : recording.measurements) {
    const auto records = tracker.step(measurement);
    if (measurement.time_s < kHandOver_s) {
      EXPECT_TRUE(records.empty());
      continue;
    }
    ASSERT_EQ(records.size(), 1u);
    EXPECT_EQ(records[0].x.size(), 4);
    EXPECT_EQ(records[0].P.cols(), 4);
    EXPECT_EQ(records[0].space, &plane_space());
  }
}

// Twice in a row they would pass for a source that has changed.
TEST(PassiveSonarTracker, TakesAFrequencyThatNoSourceHasForMissing) {
  const Recording recording = frequency_run(1);
  for (const double impossible_hz : {0.0, -50.0}) {
    PassiveSonarTracker tracker = sonar(recording), without = sonar(recording);
    for (std::size_t k = 0; k < recording.measurements.size(); ++k) {
      Measurement wrong = recording.measurements[k], missing = wrong;
      if (k > 100 && k % 10 < 3) {
        wrong.z[1] = impossible_hz;
        missing.z[1] = std::nan("");
      }
      const auto records = tracker.step(wrong), expected = without.step(missing);
      ASSERT_EQ(records.size(), expected.size());
      EXPECT_EQ(records[0].x, expected[0].x) << "at measurement " << k;
    }
    EXPECT_EQ(kinds(tracker), (std::vector{Kind::handed_over})) << impossible_hz;
  }
}

TEST(PassiveSonarTracker, FollowsASourceThatChanges) {
  constexpr double kJump_s = 480.0;
  for (const double jump_hz : {30.0, -0.5}) {
    const Recording recording = frequency_run(2, 100, jump_hz, kJump_s);
    PassiveSonarTracker tracker = sonar(recording);
    EXPECT_NEAR(last_frequency_error_hz(tracker, recording), 0.0, 0.1);
    ASSERT_EQ(kinds(tracker), (std::vector{Kind::handed_over, Kind::source_changed})) << jump_hz;
    EXPECT_EQ(tracker.events()[1].time_s, kJump_s);
    EXPECT_NEAR(tracker.events()[1].value, testing::kSource_hz + jump_hz, 0.2);
  }
}

TEST(PassiveSonarTracker, TakesOneFrequencyThatIsFarOffForAnOutlier) {
  Recording recording = frequency_run(3);
  const double clean = [&] {
    PassiveSonarTracker tracker = sonar(recording);
    return last_frequency_error_hz(tracker, recording);
  }();
  recording.measurements[60].z[1] += 5.0;
  PassiveSonarTracker tracker = sonar(recording);
  EXPECT_NEAR(last_frequency_error_hz(tracker, recording), clean, 0.01);
  EXPECT_EQ(kinds(tracker), (std::vector{Kind::handed_over}));
}

TEST(PassiveSonarTracker, SaysWhenTheTargetTurns) {
  Recording recording = frequency_run(4, 200);
  // From 800 s on the target sails another course: 90 degrees to starboard.
  RandomStream noise({.seed = 9}, StreamId::test);
  const BoundedVector at = recording.truth[0].x[100];
  for (std::size_t k = 101; k < recording.measurements.size(); ++k) {
    Measurement& m = recording.measurements[k];
    BearingFrequency<>::State x = at;
    x.segment<2>(2) << at[3], -at[2];
    x.head<2>() += (m.time_s - recording.measurements[100].time_s) * x.segment<2>(2);
    recording.truth[0].x[k] = x;
    m.z = kFrequencySensor.model(m).h(x) +
          Eigen::Vector2d(kFrequencySensor.sigma_rad * noise.normal(), kFrequencySensor.sigma_hz * noise.normal());
  }
  PassiveSonarTracker tracker = sonar(recording);
  for (const Measurement& measurement : recording.measurements) tracker.step(measurement);
  ASSERT_GE(tracker.events().size(), 2u);
  EXPECT_EQ(tracker.events()[1].kind, Kind::turn_began);
  EXPECT_GT(tracker.events()[1].time_s, 800.0);
  EXPECT_LT(tracker.events()[1].time_s, 900.0);
}

// In the middle of a log nothing is heard for longer than the filter may go without.
TEST(PassiveSonarTracker, SaysWhenItsFilterWasGivenUpAndBeginsAnotherAsItBeganTheFirst) {
  const Recording recording = frequency_run(5, 200);
  constexpr std::size_t kSilent = 100, kHeardAgain = 110;
  const FilterTrackerOptions options{.lost_after_s = 60.0};
  PassiveSonarTracker tracker = sonar(recording, {}, plane_frequency_space(), 0.0, options);
  const double again_s = recording.measurements[kHeardAgain].time_s;
  double worst_m = 0.0;
  for (std::size_t k = 0; k < recording.measurements.size(); ++k) {
    if (k > kSilent && k < kHeardAgain) continue;
    const Measurement& measurement = recording.measurements[k];
    const auto records = tracker.step(measurement);
    ASSERT_EQ(records.size(), 1u) << "the batch's, at " << measurement.time_s << " s";
    EXPECT_EQ(records[0].time_s, measurement.time_s);
    EXPECT_EQ(records[0].track, 0);
    worst_m = std::max(worst_m, (records[0].x - recording.truth[0].x[k]).head<2>().norm());
  }
  EXPECT_LT(worst_m, 1000.0) << "ten of the batch's standard deviations";
  ASSERT_EQ(kinds(tracker), (std::vector{Kind::handed_over, Kind::given_up, Kind::handed_over}));
  EXPECT_EQ(tracker.events()[1].time_s, again_s);
  EXPECT_NEAR(tracker.events()[2].time_s, again_s + kHandOver_s, 8.0);
  EXPECT_GE(tracker.events()[2].time_s, again_s + kHandOver_s);
}

TEST(PassiveSonarTracker, FilterThatFailsIsGivenUpAtOnceAndItsFailuresStayCounted) {
  const Recording recording = frequency_run(5, 100);
  PassiveSonarTracker tracker = sonar(recording);
  StepStatus last = StepStatus::ok;
  for (std::size_t k = 0; k < recording.measurements.size(); ++k) {
    Measurement measurement = recording.measurements[k];
    const bool is_absurd = k >= 80 && k < 83;
    if (is_absurd) measurement.sigma.setConstant(kInfinity);
    const auto records = tracker.step(measurement);
    ASSERT_EQ(records.size(), 1u);
    if (is_absurd) last = records[0].status;
  }
  EXPECT_EQ(last, StepStatus::failed);
  ASSERT_EQ(kinds(tracker), (std::vector{Kind::handed_over, Kind::given_up}));
  EXPECT_EQ(tracker.events()[1].time_s, recording.measurements[82].time_s);
  EXPECT_EQ(tracker.counts().failed, 3);
}

TEST(PassiveSonarTracker, RowsOlderThanTheFilterThatWasGivenUpAreOutOfOrder) {
  const Recording recording = frequency_run(5, 100);
  PassiveSonarTracker tracker = sonar(recording);
  for (std::size_t k = 0; k < 83; ++k) {
    Measurement measurement = recording.measurements[k];
    if (k >= 80) measurement.sigma.setConstant(kInfinity);
    tracker.step(measurement);
  }
  ASSERT_EQ(kinds(tracker), (std::vector{Kind::handed_over, Kind::given_up}));
  EXPECT_TRUE(tracker.step(recording.measurements[60]).empty());
  EXPECT_EQ(tracker.counts().out_of_order, 1);
}

TEST(PassiveSonarTracker, BeginsAnewAfterAReset) {
  const Recording first = frequency_run(5, 100, 10.0, 480.0);
  PassiveSonarTracker tracker = sonar(first);
  const std::unique_ptr<Tracker> other = tracker.fresh();
  const double once = last_frequency_error_hz(tracker, first);
  tracker.reset();
  EXPECT_TRUE(tracker.events().empty());
  EXPECT_EQ(last_frequency_error_hz(tracker, first), once);
  EXPECT_EQ(last_frequency_error_hz(*other, first), once);
  EXPECT_EQ(other->events().size(), tracker.events().size());
}

}  // namespace
}  // namespace truebearing::passive_sonar_tracker_test
