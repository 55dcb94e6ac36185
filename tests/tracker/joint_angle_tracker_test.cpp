// SPDX-License-Identifier: Apache-2.0
#include "truebearing/tracker/joint_angle_tracker.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "tests/support/angle_runs.hpp"
#include "tests/support/angle_trackers.hpp"
#include "tests/support/statistics.hpp"
#include "truebearing/core/chi_square.hpp"
#include "truebearing/core/covariance.hpp"

namespace truebearing::joint_angle_tracker_test {
namespace {

using testing::angle_errors;
using testing::array_run;
using testing::ArrayScene;
using testing::joint_options;
using testing::kSquareDegree;
using testing::Published;
using testing::recording_of;
using testing::scene_of;
using testing::track;

Published published(const JointAngleOptions& options, const Recording& recording) {
  JointAngleTracker tracker(options);
  return track(tracker, recording.measurements);
}

TEST(JointAngleTracker, MovingTargetsWantMovingBlocks) {
  double still = 0.0, middle = 0.0, blocks = 0.0;
  for (std::uint64_t run = 0; run < 3; ++run) {
    const Recording recording = array_run("array_a_moving_10db", run);
    JointAngleOptions options = joint_options();
    still += angle_errors(published(options, recording), recording).mse_deg2 / 3.0;
    options.moving_blocks = 1;
    middle += angle_errors(published(options, recording), recording).mse_deg2 / 3.0;
    options.moving_blocks = 3;
    blocks += angle_errors(published(options, recording), recording).mse_deg2 / 3.0;
  }
  EXPECT_LT(middle, 0.2 * still);
  EXPECT_LT(blocks, middle);
  EXPECT_LT(blocks, 1.5 * 0.0106);  // of the problem's table
}

TEST(JointAngleTracker, LearnsThePowerOfTheNoise) {
  constexpr double kNoise = 5.0;
  const Recording recording = recording_of(80, 0, [](int) {
    ArrayScene scene = scene_of({-40.0, 0.0, 40.0}, 2.0 * kNoise);
    scene.noise_power = kNoise;
    return scene;
  });
  JointAngleOptions options = joint_options(3);
  options.hypotheses.motion.q_high = options.hypotheses.motion.q_low;  // so that covariances are comparable
  options.noise_power = kNoise;
  const Published known = published(options, recording);
  options.noise_power.reset();
  const Published learnt = published(options, recording);
  options.noise_power = 1.0;
  const Published wrong = published(options, recording);
  for (std::size_t n = 0; n < 3; ++n) {
    EXPECT_NEAR(learnt.back()[n].P(0, 0) / known.back()[n].P(0, 0), 1.0, 0.1) << n;
    EXPECT_GT(std::abs(wrong.back()[n].P(0, 0) / known.back()[n].P(0, 0) - 1.0), 0.3) << n;
    EXPECT_LT(std::abs(learnt.back()[n].x[0] - known.back()[n].x[0]), 0.3 * std::sqrt(known.back()[n].P(0, 0))) << n;
  }
}

TEST(JointAngleTracker, RecordsHoldTogether) {
  const Recording recording = array_run("array_a_10db");
  JointAngleTracker tracker(joint_options());
  for (const Measurement& measurement : recording.measurements)
    for (const StepRecord& record : tracker.step(measurement)) {
      if (!record.innovation) continue;
      // The equivalent measurement takes the prediction to the estimate: in the angle exactly.
      const double K = (*record.gain)(0, 0), S = record.innovation->S(0, 0);
      EXPECT_NEAR(record.x[0], record.prediction->x[0] + K * record.innovation->nu[0], 1e-9);
      EXPECT_NEAR(record.P(0, 0), record.prediction->P(0, 0) - K * S * K, 1e-9 * S);
      EXPECT_NEAR(record.innovation->z[0], record.prediction->x[0] + record.innovation->nu[0], 1e-12);
      EXPECT_NEAR(record.innovation->nis, record.innovation->nu[0] * record.innovation->nu[0] / S, 1e-12);
      EXPECT_TRUE(is_covariance(record.prediction->P));
    }
  EXPECT_GE(tracker.hypotheses(), 1);
  EXPECT_LE(tracker.hypotheses(), 8);
  tracker.reset();
  EXPECT_EQ(tracker.hypotheses(), 0);
}

// Consistency. Two targets far apart at angular velocities and, where `q` is not zero, accelerations as the filter's
// model has them. Sums over runs, targets and steps of the NIS, and over runs and targets of the NEES at the last.
struct Consistency {
  double nis = 0.0, nis_freedom = 0.0, nees = 0.0, nees_freedom = 0.0;
};

Consistency consistency(double q_deg2ps3, const std::function<void(JointAngleOptions&)>& tune) {
  constexpr int kIntervals = 30;
  constexpr std::uint64_t kRuns = 40;
  Consistency sums;
  for (std::uint64_t run = 0; run < kRuns; ++run) {
    RandomStream random({32, Role::evaluation, run}, StreamId::test);
    std::vector<Eigen::Vector2d> truth[2];
    for (const double start_deg : {-25.0, 25.0}) {
      std::vector<Eigen::Vector2d>& path = truth[start_deg > 0.0];
      Eigen::Vector2d x(radians(start_deg), radians(0.3) * random.normal());
      path.push_back(x);
      for (int k = 1; k < kIntervals; ++k) {  // exact in T = 1 s
        const double w1 = random.normal(), w2 = random.normal(), q = q_deg2ps3 * kSquareDegree;
        x[0] += x[1] + std::sqrt(q) * (w1 / 2.0 + w2 / std::sqrt(12.0));
        x[1] += std::sqrt(q) * w1;
        path.push_back(x);
      }
    }
    const Recording recording = recording_of(kIntervals, run, [&](int k) {
      ArrayScene scene = scene_of({0.0, 0.0}, 3.0);
      for (std::size_t n = 0; n < 2; ++n) scene.angles_rad[n] = truth[n][static_cast<std::size_t>(k)][0];
      return scene;
    });
    JointAngleOptions options = joint_options(2);
    const double q = std::max(q_deg2ps3, 1e-9) * kSquareDegree;
    options.hypotheses.motion = {.q0 = q, .q_low = q, .q_high = q, .log_power_variance_per_s = 1e-6};
    options.rate_sigma_radps = radians(0.3);
    tune(options);
    const Published steps = published(options, recording);
    for (std::size_t k = 1; k < steps.size(); ++k) {
      EXPECT_EQ(steps[k].size(), 2u);
      for (const StepRecord& record : steps[k])
        if (record.innovation) {
          sums.nis += record.innovation->nis;
          sums.nis_freedom += 1.0;
        }
    }
    for (const StepRecord& record : steps.back()) {
      const Eigen::Vector2d error = record.x - truth[static_cast<std::size_t>(record.track)].back();
      sums.nees += mahalanobis_squared(record.P, error);
      sums.nees_freedom += 2.0;
    }
  }
  return sums;
}

// Two-sided intervals at 99.9 %: a correct filter fails one seed in a thousand.
bool is_low(double sum, double freedom) {
  return sum < chi_square_quantile(0.0005, freedom);
}
bool is_high(double sum, double freedom) {
  return sum > chi_square_quantile(0.9995, freedom);
}

void expect_consistent(const Consistency& sums) {
  EXPECT_FALSE(is_low(sums.nis, sums.nis_freedom)) << sums.nis / sums.nis_freedom;
  EXPECT_FALSE(is_high(sums.nis, sums.nis_freedom)) << sums.nis / sums.nis_freedom;
  EXPECT_FALSE(is_low(sums.nees, sums.nees_freedom)) << sums.nees / sums.nees_freedom;
  EXPECT_FALSE(is_high(sums.nees, sums.nees_freedom)) << sums.nees / sums.nees_freedom;
}

TEST(JointAngleTrackerConsistency, NisAndNeesAreChiSquareAtConstantRates) {
  expect_consistent(consistency(0.0, [](JointAngleOptions&) {}));
}

TEST(JointAngleTrackerConsistency, NisAndNeesAreChiSquareInManoeuvres) {
  expect_consistent(consistency(0.03, [](JointAngleOptions&) {}));
}

TEST(JointAngleTrackerConsistency, TooLittleProcessNoiseIsCaught) {
  const Consistency sums = consistency(0.03, [](JointAngleOptions& options) {
    options.hypotheses.motion.q0 *= 1e-4;
    options.hypotheses.motion.q_low *= 1e-4;
    options.hypotheses.motion.q_high *= 1e-4;
  });
  EXPECT_TRUE(is_high(sums.nis, sums.nis_freedom)) << sums.nis / sums.nis_freedom;
  EXPECT_TRUE(is_high(sums.nees, sums.nees_freedom)) << sums.nees / sums.nees_freedom;
}

TEST(JointAngleTrackerConsistency, WrongNoisePowerIsCaught) {
  const Consistency low = consistency(0.0, [](JointAngleOptions& options) { options.noise_power = 0.25; });
  EXPECT_TRUE(is_high(low.nis, low.nis_freedom)) << low.nis / low.nis_freedom;
  const Consistency high = consistency(0.0, [](JointAngleOptions& options) { options.noise_power = 4.0; });
  EXPECT_TRUE(is_low(high.nis, high.nis_freedom)) << high.nis / high.nis_freedom;
}

// A target always there, and one from 20 to 50 s.
Recording coming_and_going(std::uint64_t run) {
  return recording_of(80, run, [](int k) {
    return k >= 20 && k < 50 ? scene_of({-30.0 + 0.2 * k, 25.0 - 0.3 * (k - 20)}, 1.0)
                             : scene_of({-30.0 + 0.2 * k}, 1.0);
  });
}

JointAngleOptions lifetime_options(int targets) {
  JointAngleOptions options = joint_options(targets);
  options.lifetimes.emplace();
  return options;
}

TEST(JointAngleTracker, TargetThatAppearsGetsATrackAndOneThatVanishesLosesIt) {
  for (std::uint64_t run = 0; run < 10; ++run) {
    const Recording recording = coming_and_going(run);
    JointAngleTracker tracker(lifetime_options(1));
    const Published steps = track(tracker, recording.measurements);
    const std::span<const TrackEvent> events = tracker.events();
    ASSERT_EQ(events.size(), 3u) << run;
    EXPECT_EQ(events[0].kind, TrackEvent::Kind::track_began);
    EXPECT_EQ(events[0].time_s, 0.0);
    EXPECT_EQ(events[0].value, 0.0);
    EXPECT_EQ(events[1].kind, TrackEvent::Kind::track_began);
    EXPECT_GE(events[1].time_s, 20.0);
    EXPECT_LE(events[1].time_s, 24.0);
    EXPECT_EQ(events[1].value, 1.0);
    EXPECT_EQ(events[2].kind, TrackEvent::Kind::track_ended);
    EXPECT_GE(events[2].time_s, 50.0);
    EXPECT_LE(events[2].time_s, 60.0);
    EXPECT_EQ(events[2].value, 1.0);
    for (std::size_t k = 0; k < steps.size(); ++k) {
      const double time_s = static_cast<double>(k);
      const bool is_followed = time_s >= events[1].time_s && time_s < events[2].time_s;
      ASSERT_EQ(steps[k].size(), is_followed ? 2u : 1u) << run << ", " << k;
      EXPECT_EQ(steps[k][0].track, 0);
      if (k >= 5) {
        EXPECT_NEAR(degrees(steps[k][0].x[0]), -30.0 + 0.2 * time_s, 2.0) << run << ", " << k;
      }
      if (is_followed && time_s > events[1].time_s + 5.0 && time_s < 50.0) {
        EXPECT_EQ(steps[k][1].track, 1);
        EXPECT_NEAR(degrees(steps[k][1].x[0]), 25.0 - 0.3 * (time_s - 20.0), 2.0) << run << ", " << k;
      }
      for (const StepRecord& record : steps[k]) EXPECT_TRUE(is_covariance(record.P));
    }
    tracker.reset();
    EXPECT_TRUE(tracker.events().empty());
  }
}

// A signal so strong that what a grid of angles leaves of it could be heard once more in the same interval.
TEST(JointAngleTracker, StrongNewcomerIsOneTrackOfTwoIntervals) {
  for (std::uint64_t run = 0; run < 10; ++run) {
    const Recording recording = recording_of(40, run, [&](int k) {
      ArrayScene scene = scene_of({-30.0});
      if (k >= 20) {
        scene.angles_rad.push_back(radians(25.3 + 0.07 * static_cast<double>(run)));
        scene.powers.push_back(100.0);
      }
      return scene;
    });
    JointAngleOptions options = lifetime_options(1);
    options.lifetimes->begin_hits = 2;
    JointAngleTracker tracker(options);
    const Published steps = track(tracker, recording.measurements);
    ASSERT_EQ(tracker.events().size(), 2u) << run;
    EXPECT_EQ(tracker.events()[1].time_s, 21.0) << run;
    EXPECT_EQ(steps.back().size(), 2u) << run;
  }
}

TEST(JointAngleTracker, WithLifetimesMayBeginWithNobody) {
  const Recording recording = recording_of(40, 0, [](int k) {
    return k < 10 ? scene_of({}) : scene_of({-20.0, 30.0}, 1.0);
  });
  JointAngleTracker tracker(lifetime_options(0));
  const Published steps = track(tracker, recording.measurements);
  for (std::size_t k = 0; k < 10; ++k) EXPECT_TRUE(steps[k].empty()) << k;
  ASSERT_EQ(steps.back().size(), 2u);
  EXPECT_NEAR(std::min(steps.back()[0].x[0], steps.back()[1].x[0]), radians(-20.0), radians(1.0));
  EXPECT_NEAR(std::max(steps.back()[0].x[0], steps.back()[1].x[0]), radians(30.0), radians(1.0));
}

// Twice a gain of the log likelihood of 30, by noise alone, has a probability of some 1e-7 an angle and interval: not
// one false track is to be expected in 1000 intervals. With a bar of 6 there are some.
TEST(JointAngleTracker, NoTrackBeginsOfNoise) {
  const auto began = [](double begin_presence) {
    std::size_t false_tracks = 0;
    for (std::uint64_t run = 0; run < 5; ++run) {
      const Recording recording = recording_of(200, run, [](int k) {
        return scene_of({-30.0 + 10.0 * std::sin(0.1 * k), 20.0, 45.0}, 3.0);
      });
      JointAngleOptions options = lifetime_options(3);
      options.lifetimes->begin_presence = begin_presence;
      JointAngleTracker tracker(options);
      track(tracker, recording.measurements);
      for (const TrackEvent& event : tracker.events())
        false_tracks += event.kind == TrackEvent::Kind::track_began && event.time_s > 0.0;
    }
    return false_tracks;
  };
  EXPECT_EQ(began(30.0), 0u);
  EXPECT_GT(began(6.0), 0u);
}

TEST(JointAngleTracker, MissingIntervalsEndNoTrack) {
  const Recording recording = coming_and_going(0);
  JointAngleTracker tracker(lifetime_options(1));
  for (std::size_t k = 0; k < 40; ++k) {
    Measurement measurement = recording.measurements[k];
    if (k >= 30) measurement.snapshots.reset();
    const std::size_t records = tracker.step(measurement).size();
    if (k >= 30) {
      EXPECT_EQ(records, 2u) << k;
    }
  }
  EXPECT_EQ(tracker.events().size(), 2u);
}

}  // namespace
}  // namespace truebearing::joint_angle_tracker_test
