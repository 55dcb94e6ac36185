// SPDX-License-Identifier: Apache-2.0
#include "truebearing/tracker/joint_angle_tracker.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "truebearing/core/angle.hpp"
#include "truebearing/simulation/line_array_scenario.hpp"

namespace truebearing::joint_angle_lifetimes_test {
namespace {

using Lifetimes = JointAngleOptions::Lifetimes;

Recording simulated(const std::string& targets, std::uint64_t run = 0) {
  const SharedTable table = parse_toml(
      "kind = \"line_array\"\nperiod_s = 1.0\nintervals = 60\n[array]\nsensors = 15\nsnapshots = 30\n"
      "[signals]\nsnr_db = 5.0\n" +
          targets,
      "scenario.toml");
  return read_scenario(TableReader(table, "scenario.toml"))->simulate({.seed = 5, .run = run});
}

JointAngleOptions options(const Lifetimes& lifetimes = {}) {
  JointAngleOptions options;
  options.targets = OrderCriterion::minimum_description_length;
  JointAngleMotion& motion = options.hypotheses.motion;
  motion.q0 = motion.q_low = motion.q_high = 0.03 * radians(1.0) * radians(1.0);
  motion.log_power_variance_per_s = 1e-3;
  options.lifetimes = lifetimes;
  return options;
}

struct Followed {
  std::vector<std::size_t> tracks;  // [interval]: how many
  std::vector<TrackEvent> events;
};

Followed follow(const Recording& recording, const Lifetimes& lifetimes = {}) {
  JointAngleTracker tracker(options(lifetimes));
  Followed followed;
  for (const Measurement& measurement : recording.measurements)
    followed.tracks.push_back(tracker.step(measurement).size());
  followed.events.assign(tracker.events().begin(), tracker.events().end());
  return followed;
}

int began(const Followed& followed) {
  int count = 0;
  for (const TrackEvent& event : followed.events) count += event.kind == TrackEvent::Kind::track_began;
  return count;
}

TEST(JointAngleTracker, TargetsThatALongGapHasLostAreBegunAnew) {
  const Recording recording = simulated("[[targets]]\nstart_deg = -20.0\n[[targets]]\nstart_deg = 30.0\n");
  JointAngleOptions without_lifetimes = options();
  without_lifetimes.lifetimes.reset();
  JointAngleTracker tracker(without_lifetimes);
  constexpr std::size_t kGapAt = 30;
  for (std::size_t k = 0; k < kGapAt; ++k) ASSERT_EQ(tracker.step(recording.measurements[k]).size(), 2u);
  Measurement silent = recording.measurements[kGapAt];
  silent.time_s += 900.0;
  silent.snapshots.reset();
  for (const StepRecord& record : tracker.step(silent)) {
    EXPECT_EQ(record.status, StepStatus::failed) << "not known any more";
    EXPECT_LT(std::abs(record.x[0]), 0.5 * kPi);
  }
  for (std::size_t k = kGapAt; k < recording.measurements.size(); ++k) {
    Measurement later = recording.measurements[k];
    later.time_s += 1000.0;
    const auto records = tracker.step(later);
    ASSERT_EQ(records.size(), 2u);
    for (const StepRecord& record : records) {
      EXPECT_EQ(record.status, StepStatus::ok);
      EXPECT_GE(record.track, 2) << "another than before";
      EXPECT_LT(std::min(std::abs(record.x[0] + radians(20.0)), std::abs(record.x[0] - radians(30.0))), radians(1.0));
    }
  }
}

constexpr const char* kOneAndAGuest =
    "[[targets]]\nstart_deg = -20.0\nrate_degps = 0.3\n"
    "[[targets]]\nstart_deg = 30.0\nappears_s = 20.0\nvanishes_s = 40.0\n";

TEST(JointAngleTrackerLifetimes, ATrackIsThereWhileItsTargetIs) {
  for (std::uint64_t run = 0; run < 20; ++run) {
    const Recording recording = simulated(kOneAndAGuest, run);
    const Followed followed = follow(recording);
    EXPECT_EQ(began(followed), 2);
    for (std::size_t k = 0; k < followed.tracks.size(); ++k) {
      const double time_s = recording.measurements[k].time_s;
      if (time_s == 20.0 || time_s == 40.0) continue;  // heard in part of the interval
      EXPECT_EQ(followed.tracks[k], time_s > 20.0 && time_s < 40.0 ? 2u : 1u) << time_s << " s, run " << run;
    }
  }
}

TEST(JointAngleTrackerLifetimes, HitsAndMissesDelayBeginningAndEnd) {
  const Recording recording = simulated(kOneAndAGuest);
  const auto count = [&](const Lifetimes& lifetimes) {
    std::size_t two = 0;
    for (const std::size_t tracks : follow(recording, lifetimes).tracks) two += tracks == 2;
    return static_cast<int>(two);
  };
  const int plain = count({});
  EXPECT_EQ(count({.begin_hits = 3}), plain - 2);
  EXPECT_EQ(count({.end_misses = 5}), plain + 4);
}

// They are one target to the array for a dozen intervals. With no patience for that one of them ends.
TEST(JointAngleTrackerLifetimes, TwoThatMeetAreKeptApart) {
  const std::string slow =
      "[[targets]]\nstart_deg = -6.0\nrate_degps = 0.2\n[[targets]]\nstart_deg = 6.0\nrate_degps = -0.2\n";
  int patient = 0, impatient = 0;
  for (std::uint64_t run = 0; run < 20; ++run) {
    const Recording recording = simulated(slow, run);
    patient += began(follow(recording));
    impatient += began(follow(recording, {.close_misses = 0}));
  }
  EXPECT_LE(patient, 2 * 20 + 2) << "tracks that began";
  EXPECT_GT(impatient, patient + 5);
}

TEST(JointAngleTrackerLifetimes, NoiseBeginsNoTrack) {
  const std::string silence = "[[targets]]\nstart_deg = 0.0\nappears_s = 1000.0\n";
  for (std::uint64_t run = 0; run < 50; ++run) EXPECT_EQ(began(follow(simulated(silence, run))), 0) << run;
}

}  // namespace
}  // namespace truebearing::joint_angle_lifetimes_test
