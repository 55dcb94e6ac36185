// SPDX-License-Identifier: Apache-2.0
#include "truebearing/simulation/look_schedule.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "truebearing/core/constants.hpp"
#include "truebearing/simulation/scenario.hpp"

namespace truebearing::look_schedule_test {
namespace {

LookSchedule schedule(const std::string& looks) {
  TableReader reader(parse_toml("[looks]\n" + looks, "scenario.toml"), "scenario.toml");
  return read_look_schedule(reader);
}

RunKey run(std::uint64_t number) {
  return {.seed = 3, .role = Role::evaluation, .run = number};
}

TEST(LookSchedule, WithoutOneEveryPeriodIsSeen) {
  const std::vector<Look> looks = LookSchedule{}.draw(5.0, 4, run(0));
  ASSERT_EQ(looks.size(), 4u);
  for (std::size_t k = 0; k < 4; ++k) {
    EXPECT_EQ(looks[k].time_s, 5.0 * static_cast<double>(k + 1));
    EXPECT_TRUE(looks[k].seen);
  }
}

TEST(LookSchedule, PeriodIsDrawnOncePerRun) {
  const LookSchedule drawn = schedule("period_factor = { uniform = [0.5, 3.0] }\n");
  double lowest = kInfinity, highest = 0.0;
  for (std::uint64_t number = 0; number < 200; ++number) {
    const std::vector<Look> looks = drawn.draw(2.0, 10, run(number));
    const double period = looks[0].time_s;
    for (std::size_t k = 1; k < 10; ++k) EXPECT_NEAR(looks[k].time_s - looks[k - 1].time_s, period, 1e-12);
    lowest = std::min(lowest, period);
    highest = std::max(highest, period);
  }
  EXPECT_GE(lowest, 1.0);
  EXPECT_LT(lowest, 1.25) << "all 200 above it: 4e-5";
  EXPECT_LE(highest, 6.0);
  EXPECT_GT(highest, 5.75);
}

TEST(LookSchedule, GapsAreDrawnOneByOne) {
  const std::vector<Look> looks = schedule("gap_factor = { uniform = [0.2, 2.0] }\n").draw(1.0, 2000, run(0));
  double mean = 0.0;
  for (std::size_t k = 1; k < looks.size(); ++k) {
    const double gap = looks[k].time_s - looks[k - 1].time_s;
    EXPECT_GE(gap, 0.2);
    EXPECT_LE(gap, 2.0);
    mean += gap / static_cast<double>(looks.size() - 1);
  }
  EXPECT_NEAR(mean, 1.1, 4.0 * 1.8 / std::sqrt(12.0 * 2000.0));
}

TEST(LookSchedule, MissesAreOfTheShareThatIsAskedFor) {
  const std::vector<Look> looks = schedule("missed = 0.7\n").draw(1.0, 4000, run(1));
  const auto missed = std::count_if(looks.begin(), looks.end(), [](const Look& look) { return !look.seen; });
  EXPECT_NEAR(static_cast<double>(missed) / 4000.0, 0.7, 4.0 * std::sqrt(0.21 / 4000.0));
}

TEST(LookSchedule, OutagesLastAsLongAsTheySay) {
  const std::vector<Look> looks =
      schedule("outage_share = 1.0\nseen_s = 10.0\nunseen_s = 5.0\n").draw(1.0, 150, run(2));
  int changes = 0;
  for (std::size_t k = 1; k < looks.size(); ++k) changes += looks[k].seen != looks[k - 1].seen;
  const auto unseen = std::count_if(looks.begin(), looks.end(), [](const Look& look) { return !look.seen; });
  EXPECT_NEAR(changes, 20, 1) << "ten rounds of 15 s";
  EXPECT_NEAR(static_cast<double>(unseen), 50.0, 5.0);
}

TEST(LookSchedule, OneLookIsSeenWhateverIsDrawn) {
  const std::vector<Look> looks = schedule("missed = 1.0\n").draw(1.0, 20, run(3));
  EXPECT_EQ(std::count_if(looks.begin(), looks.end(), [](const Look& look) { return look.seen; }), 1);
}

constexpr const char* kFlight = R"(
kind = "planar_flight"
output = "plane"
period_s = 2.0
steps = 60
[flight]
speed_mps = { uniform = [100.0, 200.0] }
leg_s = { uniform = [10.0, 20.0] }
turn_s = { uniform = [10.0, 20.0] }
turn_rate_degps = 3.0
roll_in_s = 0.0
[sensor]
position_sigma_m = 50.0
)";

Recording flight(const std::string& looks, std::uint64_t number = 5) {
  return read_scenario(TableReader(parse_toml(kFlight + looks, "scenario.toml"), "scenario.toml"))
      ->simulate(run(number));
}

TEST(LookSchedule, TargetFliesTheSameHoweverItIsLookedAt) {
  const Recording regular = flight(""), twice = flight("[looks]\nperiod_factor = 0.5\n");
  for (std::size_t k = 0; k < 29; ++k)  // samples at 2, 4, .. s; the second recording has begun a second earlier
    EXPECT_LT((regular.truth[0].x[k] - twice.truth[0].x[2 * k]).norm(), 1e-6) << k;
}

TEST(LookSchedule, UnseenLooksLeaveNoRowOrAnEmptyOne) {
  const Recording absent = flight("[looks]\nmissed = 0.5\n");
  const Recording empty = flight("[looks]\nmissed = 0.5\nempty_rows = true\n");
  EXPECT_EQ(empty.measurements.size(), 60u);
  EXPECT_EQ(empty.counts.missing, 60 - static_cast<int>(absent.measurements.size()));
  std::size_t next = 0;
  for (std::size_t k = 0; k < 60; ++k) {
    if (empty.measurements[k].is_missing()) continue;
    EXPECT_EQ(empty.measurements[k].z, absent.measurements.at(next).z);
    EXPECT_EQ(empty.truth[0].x[k], absent.truth[0].x[next++]);
  }
  EXPECT_EQ(next, absent.measurements.size());
}

}  // namespace
}  // namespace truebearing::look_schedule_test
