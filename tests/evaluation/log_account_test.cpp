// SPDX-License-Identifier: Apache-2.0
#include "truebearing/evaluation/log_account.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/line_trackers.hpp"

namespace truebearing::log_account_test {
namespace {

using ::testing::ElementsAre;
using testing::RadarFilter;

TrackerSet gated_set() {
  Ensemble ensemble;
  RadarFilter radar;
  radar.options = {.gate_nis = 9.0};
  ensemble.add("plain", radar.tracker());
  TrackerSet set(std::move(ensemble));
  set.show_member("plain");
  return set;
}

// One that is missing, one that is repeated, one that comes late and one that is far off.
Recording log_at(double epoch_s) {
  Recording recording;
  recording.measured = {"position_m"};
  const auto add = [&](double time_s, double z_m) {
    recording.measurements.push_back(testing::position(epoch_s + time_s, z_m));
  };
  add(1.0, 100.0);
  add(2.0, kNaN);
  add(3.0, 300.0);
  add(3.0, 300.0);
  add(2.5, 200.0);
  add(4.0, 1e6);
  add(5.0, 500.0);
  return recording;
}

TEST(LogAccount, SaysWhatWasNotUsedAndWhy) {
  LogFollower follower(gated_set());
  follower.follow(log_at(1e6), 0, 1e6);
  const LogAccount account = follower.take();
  ASSERT_EQ(account.trackers.size(), 1u);
  std::vector<std::string> why;
  std::vector<double> time_s;
  for (const TrackerOnLog::NotUsed& one : account.trackers[0].not_used) {
    why.push_back(one.why);
    time_s.push_back(one.time_s);
    EXPECT_EQ(std::isfinite(one.nis), one.why == "gated");
  }
  EXPECT_THAT(why, ElementsAre("missing", "repeated", "late", "gated"));
  EXPECT_THAT(time_s, ElementsAre(1e6 + 2.0, 1e6 + 3.0, 1e6 + 2.5, 1e6 + 4.0)) << "times of the log";
}

TEST(LogAccount, KeepsInnovationsAsTheTrackerHasThem) {
  TrackerSet set = gated_set();
  const Recording recording = log_at(0.0);
  std::vector<double> sigmas, nis;
  for (const Measurement& measurement : recording.measurements) {
    set.step(measurement);
    for (const StepRecord& record : set.records(0))
      if (record.innovation) {
        sigmas.push_back(record.innovation->nu[0] / std::sqrt(record.innovation->S(0, 0)));
        nis.push_back(record.innovation->nis);
      }
  }
  LogFollower follower(set);
  follower.follow(recording, 0, 0.0);
  const LogAccount account = follower.take();
  const TrackerOnLog::Innovations& innovations = account.trackers[0].innovations;
  EXPECT_EQ(innovations.sigmas, sigmas);
  EXPECT_EQ(innovations.nis, nis);
  for (std::size_t i = 0; i < nis.size(); ++i) {
    EXPECT_NEAR(sigmas[i] * sigmas[i], nis[i], 1e-9 * nis[i]) << "of one component";
    EXPECT_EQ(innovations.freedom[i], 1.0);
  }
  EXPECT_GT(std::count(innovations.used.begin(), innovations.used.end(), true), 0);
  EXPECT_EQ(std::count(innovations.used.begin(), innovations.used.end(), false), 1) << "the gated one";
}

TEST(LogAccount, DrawsTracksAndTellsSeveralLogsApart) {
  LogFollower follower(gated_set());
  follower.follow(log_at(0.0), 4, 0.0);
  follower.follow(log_at(0.0), 7, 0.0);
  const LogAccount account = follower.take();
  EXPECT_FALSE(account.picture.in_plane);
  EXPECT_EQ(account.picture.component, "position_m");
  ASSERT_EQ(account.picture.tracks.size(), 2u);
  EXPECT_EQ(account.picture.tracks[0].line.track, 4);
  EXPECT_EQ(account.picture.tracks[1].line.track, 7);
  EXPECT_EQ(account.picture.tracks[0].line.y, account.picture.tracks[1].line.y) << "each begins afresh";
  EXPECT_EQ(account.picture.measured.y.size(), 14u);
}

}  // namespace
}  // namespace truebearing::log_account_test
