// SPDX-License-Identifier: Apache-2.0
#include "truebearing/tracker/subspace_angle_tracker.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/angle_runs.hpp"
#include "tests/support/angle_trackers.hpp"
#include "truebearing/core/covariance.hpp"

namespace truebearing::subspace_angle_tracker_test {
namespace {

using testing::angle_errors;
using testing::array_run;
using testing::paper_options;
using testing::Published;
using testing::recording_of;
using testing::scene_of;
using testing::track;

using Innovation = SubspaceAngleOptions::Innovation;
using Subspace = SubspaceAngleOptions::Subspace;

Published published(const SubspaceAngleOptions& options, const Recording& recording) {
  SubspaceAngleTracker tracker(options);
  return track(tracker, recording.measurements);
}

TEST(SubspaceAngleTracker, PapersTwoEquationsAndTheImplicitFormAreOneEstimate) {
  for (std::uint64_t run = 0; run < 3; ++run) {
    const Recording recording = array_run("array_a_0db", run);
    SubspaceAngleOptions options = paper_options();
    std::vector<Published> ways;
    for (const Innovation innovation : {Innovation::ryu, Innovation::projection, Innovation::implicit}) {
      options.innovation = innovation;
      ways.push_back(published(options, recording));
    }
    for (std::size_t k = 1; k < ways[0].size(); ++k)
      for (std::size_t n = 0; n < 5; ++n)
        for (const std::size_t way : {1u, 2u})
          EXPECT_LT(std::abs(ways[way][k][n].x[0] - ways[0][k][n].x[0]), radians(1e-9)) << run << ", " << k;
  }
}

TEST(SubspaceAngleTracker, BeginsWithTwoIntervalsInTheOrderOfTheAngles) {
  const Recording recording = recording_of(3, 0, [](int k) {
    return scene_of({30.0 - k, -20.0, 5.0 + 2.0 * k}, 1000.0);
  });
  SubspaceAngleTracker tracker(paper_options(3));
  EXPECT_TRUE(tracker.step(recording.measurements[0]).empty());
  const auto records = tracker.step(recording.measurements[1]);
  ASSERT_EQ(records.size(), 3u);
  const double angles_deg[] = {-20.0, 7.0, 29.0}, rates_degps[] = {0.0, 2.0, -1.0};
  for (std::size_t n = 0; n < 3; ++n) {
    EXPECT_EQ(records[n].track, static_cast<int>(n));
    EXPECT_EQ(records[n].status, StepStatus::ok);
    EXPECT_FALSE(records[n].innovation);
    EXPECT_NEAR(degrees(records[n].x[0]), angles_deg[n], 0.1);
    EXPECT_NEAR(degrees(records[n].x[1]), rates_degps[n], 0.1);
    // Equation (21), corrected: sigma^2 [1 1/T; 1/T 2/T^2].
    const double variance = radians(2.0) * radians(2.0);
    EXPECT_NEAR(records[n].P(0, 0), variance, 1e-12);
    EXPECT_NEAR(records[n].P(0, 1), variance, 1e-12);
    EXPECT_NEAR(records[n].P(1, 1), 2.0 * variance, 1e-12);
  }
}

TEST(SubspaceAngleTracker, TargetsThatLeaveTheSectorAreBegunAnew) {
  // One passes along end-fire, where sines tell little of angles and -90 deg is heard as 90.
  const Recording recording = recording_of(60, 0, [](int k) { return scene_of({-89.0 + 0.5 * k, 20.0}, 10.0); });
  SubspaceAngleTracker tracker(paper_options(2));
  int newest = 0;
  std::vector<double> last_deg;
  for (const Measurement& measurement : recording.measurements) {
    last_deg.clear();
    for (const StepRecord& record : tracker.step(measurement)) {
      EXPECT_LT(std::abs(degrees(record.x[0])), 90.0);
      EXPECT_LT(std::abs(degrees(record.prediction->x[0])), 100.0);
      EXPECT_TRUE(is_covariance(record.P));
      newest = std::max(newest, record.track);
      last_deg.push_back(degrees(record.x[0]));
    }
  }
  EXPECT_GT(newest, 1) << "the first two are lost";
  ASSERT_EQ(last_deg.size(), 2u);
  EXPECT_NEAR(std::min(last_deg[0], last_deg[1]), -59.5, 1.0);
  EXPECT_NEAR(std::max(last_deg[0], last_deg[1]), 20.0, 1.0);
  tracker.reset();
  tracker.step(recording.measurements[0]);
  EXPECT_EQ(tracker.step(recording.measurements[1])[0].track, 0);
}

TEST(SubspaceAngleTracker, OutagesAreCrossedInsideTheSector) {
  const Recording recording = recording_of(60, 0, [](int) { return scene_of({-30.0, 20.0}, 10.0); });
  for (const double outage_s : {60.0, 200.0, 1000.0}) {
    SubspaceAngleTracker tracker(paper_options(2));
    std::size_t records = 0;
    for (Measurement measurement : recording.measurements) {
      if (measurement.time_s > 30.0) measurement.time_s += outage_s;
      const auto step = tracker.step(measurement);
      for (const StepRecord& record : step) EXPECT_LT(std::abs(degrees(record.x[0])), 90.0);
      records = step.size();
      if (measurement.time_s < outage_s + 50.0) continue;
      for (const StepRecord& record : step) EXPECT_EQ(record.status, StepStatus::ok) << outage_s;
    }
    EXPECT_EQ(records, 2u);
  }
}

TEST(SubspaceAngleTracker, MoreTargetsThanAnArrayTellsApartAreNotFollowedAsFewer) {
  const Recording recording = array_run("array_a_10db");
  SubspaceAngleTracker tracker(paper_options(15));
  for (const Measurement& measurement : recording.measurements) EXPECT_TRUE(tracker.step(measurement).empty());
}

TEST(SubspaceAngleTracker, RecordsAreThoseOfTheKalmanFilter) {
  const Recording recording = array_run("array_a_10db");
  SubspaceAngleOptions options = paper_options();
  options.lag_intervals = 0.27;
  for (const std::vector<StepRecord>& records : published(options, recording))
    for (const StepRecord& record : records) {
      if (!record.innovation) continue;
      const Eigen::RowVector2d H(1.0, -0.27);
      const double S = (H * record.prediction->P * H.transpose()).value() + radians(2.0) * radians(2.0);
      EXPECT_NEAR(record.innovation->S(0, 0), S, 1e-12 * S);
      const Eigen::Vector2d K = record.prediction->P * H.transpose() / S;
      EXPECT_LT((*record.gain - K).norm(), 1e-12);
      EXPECT_LT((record.x - record.prediction->x - K * record.innovation->nu[0]).norm(), 1e-12);
    }
}

TEST(SubspaceAngleTracker, LagThatPastHasIsTakenOut) {
  const double forgotten = std::pow(0.95, 30);
  double plain = 0.0, lag_fixed = 0.0;
  for (std::uint64_t run = 0; run < 4; ++run) {
    const Recording recording = array_run("array_a_10db", run);
    SubspaceAngleOptions options = paper_options();
    plain += angle_errors(published(options, recording), recording).mse_deg2 / 4.0;
    options.lag_intervals = forgotten / (1.0 - forgotten);
    lag_fixed += angle_errors(published(options, recording), recording).mse_deg2 / 4.0;
  }
  EXPECT_LT(lag_fixed, 0.6 * plain);
  EXPECT_LT(lag_fixed, 0.06);  // .05 in the problem's table
}

TEST(SubspaceAngleTracker, VarianceFromTheSubspaceGrowsWithTheNoise) {
  const auto last_variance = [](double power, bool from_subspace) {
    const Recording recording = recording_of(10, 0, [&](int) { return scene_of({-20.0, 20.0}, power); });
    SubspaceAngleOptions options = paper_options(2);
    options.subspace = Subspace::orthogonal_iteration;
    options.sigma_rad = radians(0.05);
    options.sigma_from_subspace = from_subspace;
    const StepRecord record = published(options, recording).back()[0];
    return record.innovation->S(0, 0) - record.prediction->P(0, 0);
  };
  EXPECT_NEAR(last_variance(10.0, false), radians(0.05) * radians(0.05), 1e-12);
  EXPECT_NEAR(last_variance(1.0, false), radians(0.05) * radians(0.05), 1e-12);
  // (1 + 1 / (M snr)) / (2 Ns snr d' P_perp d); of a target by itself d' P_perp d = M (M^2 - 1) / 12 (pi cos)^2.
  for (const double snr : {1.0, 10.0}) {
    const double turn = kPi * std::cos(radians(20.0));
    const double music = (1.0 + 1.0 / (15.0 * snr)) / (60.0 * snr * 15.0 * 224.0 / 12.0 * turn * turn);
    EXPECT_NEAR((last_variance(snr, true) - radians(0.05) * radians(0.05)) / music, 1.0, 0.5) << snr;
  }
}

TEST(SubspaceAngleTracker, VarianceGrowsWhereTargetsMeet) {
  const Recording recording = recording_of(12, 0, [](int) { return scene_of({-20.0, 10.0, 12.0}, 100.0); });
  SubspaceAngleOptions options = paper_options(3);
  options.subspace = Subspace::orthogonal_iteration;
  options.inflate_within_rad = radians(5.0);
  const std::vector<StepRecord> records = published(options, recording).back();
  const auto variance = [](const StepRecord& record) {
    return (record.innovation->S(0, 0) - record.prediction->P(0, 0)) / (radians(2.0) * radians(2.0));
  };
  const double apart_deg = degrees(records[2].prediction->x[0] - records[1].prediction->x[0]);
  EXPECT_NEAR(variance(records[0]), 1.0, 1e-9);
  EXPECT_NEAR(variance(records[1]), 1.0 + 25.0 / (apart_deg * apart_deg), 1e-6);
  EXPECT_NEAR(variance(records[2]), variance(records[1]), 1e-9);
}

TEST(SubspaceAngleTracker, UnresolvedTargetsBeginAtTwoAnglesNearThem) {
  int near = 0;
  for (std::uint64_t run = 0; run < 10; ++run) {
    const Recording recording = recording_of(2, run, [](int) { return scene_of({9.0, 11.0, -40.0}); });
    const std::vector<StepRecord> records = published(paper_options(3), recording).back();
    ASSERT_EQ(records.size(), 3u);
    near += std::abs(records[1].x[0] - radians(10.0)) < radians(4.0) &&
            std::abs(records[2].x[0] - radians(10.0)) < radians(4.0);
  }
  EXPECT_GE(near, 9);
}

TEST(SubspaceAngleTracker, NeverLeavesTheAnglesThereAre) {
  const Recording recording = recording_of(60, 0, [](int k) { return scene_of({std::min(60.0 + k, 89.0), 0.0}); });
  for (const std::vector<StepRecord>& records : published(paper_options(2), recording))
    for (const StepRecord& record : records) {
      EXPECT_TRUE(record.x.allFinite());
      EXPECT_TRUE(is_covariance(record.P));
    }
}

}  // namespace
}  // namespace truebearing::subspace_angle_tracker_test
