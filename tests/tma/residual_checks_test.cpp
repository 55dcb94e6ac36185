// SPDX-License-Identifier: Apache-2.0
#include "truebearing/tma/residual_checks.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/bearing_frequency_runs.hpp"
#include "tests/support/bearing_runs.hpp"
#include "tests/support/tma_rates.hpp"
#include "truebearing/tma/target_motion_batch.hpp"

namespace truebearing::residual_checks_test {
namespace {

using testing::data_scenario;
using testing::two_legs;
using testing::window_of;

const Eigen::Vector4d kTarget(3000.0, 5000.0, -2.0, 1.0);

// The same own ship; the target's velocity changes at change_s.
BearingWindow with_a_manoeuvre(const Eigen::Vector2d& change_mps, double change_s, std::uint64_t run) {
  const BearingWindow straight = two_legs(kTarget, 300.0, 1200.0, 1.0, run);
  BearingWindow window;
  for (std::size_t i = 0; i < straight.size(); ++i) {
    const double t = straight.time_s(i);
    const Eigen::Vector2d d = kTarget.head<2>() + t * kTarget.tail<2>() - straight.site_m(i);
    const Eigen::Vector2d moved = d + std::max(t - change_s, 0.0) * change_mps;
    const double noise = straight.bearing_rad(i) - std::atan2(d.x(), d.y());
    window.add(t, std::atan2(moved.x(), moved.y()) + noise, radians(1.0), straight.site_m(i));
  }
  return window;
}

TEST(ResidualChecks, RarelyAlarmWhereNothingIsWrong) {
  constexpr int kRuns = 1000;
  const auto scenario = data_scenario("bearings_only_observable");
  TargetMotionBatch batch;
  int manoeuvres = 0, unfit = 0, coloured = 0;
  for (std::uint64_t run = 0; run < kRuns; ++run) {
    const BearingWindow window = window_of(scenario->simulate({7, Role::evaluation, run}));
    const ResidualChecks checks = check_residuals(window, batch.solve(window));
    manoeuvres += checks.manoeuvred;
    unfit += !checks.fits;
    coloured += !checks.white;
  }
  // At a rate of one in a thousand each, nine or more come once in a million.
  EXPECT_LT(manoeuvres, 9);
  EXPECT_LT(unfit, 9);
  EXPECT_LT(coloured, 9);
}

TEST(ResidualChecks, FindAManoeuvreInsideTheWindowAndItsTime) {
  TargetMotionBatch batch;
  double mean_s = 0.0;
  for (std::uint64_t run = 0; run < 20; ++run) {
    const BearingWindow window = with_a_manoeuvre({5.0, -3.0}, 700.0, run);
    const ResidualChecks checks = check_residuals(window, batch.solve(window));
    EXPECT_TRUE(checks.manoeuvred) << run << " " << checks.manoeuvre;
    mean_s += checks.manoeuvre_s / 20.0;
  }
  EXPECT_NEAR(mean_s, 700.0, 60.0);
}

TEST(ResidualChecks, NoticeNoiseLargerThanItIsSaidToBe) {
  TargetMotionBatch batch;
  const BearingWindow window = two_legs(kTarget, 300.0, 1200.0, 2.0);
  EXPECT_FALSE(check_residuals(window, batch.solve(window)).fits);
}

TEST(ResidualChecks, NoticeNoiseThatIsNotWhite) {
  const BearingWindow clean = two_legs(kTarget, 300.0, 1200.0);
  RandomStream stream({1, Role::evaluation, 0}, StreamId::test);
  BearingWindow window;
  double noise = 0.0;
  for (std::size_t i = 0; i < clean.size(); ++i) {
    noise = 0.8 * noise + 0.6 * stream.normal();
    window.add(clean.time_s(i), clean.bearing_rad(i) + radians(1.0) * noise, radians(1.0), clean.site_m(i));
  }
  TargetMotionBatch batch;
  EXPECT_FALSE(check_residuals(window, batch.solve(window)).white);
}

TEST(ResidualChecks, OfBearingsAndFrequenciesRarelyAlarmWhereNothingIsWrong) {
  constexpr int kRuns = 1000;
  TargetMotionBatch batch;
  int manoeuvres = 0, unfit = 0, coloured = 0;
  for (std::uint64_t run = 0; run < kRuns; ++run) {
    const auto [bearings, frequencies] = testing::KimSong::windows(run);
    const ResidualChecks checks =
        check_residuals(bearings, batch.solve(bearings, std::nullopt, nullptr, &frequencies), &frequencies);
    EXPECT_EQ(checks.degrees_of_freedom, 151 + 151 - 5);
    manoeuvres += checks.manoeuvred;
    unfit += !checks.fits;
    coloured += !checks.white;
  }
  EXPECT_LT(manoeuvres, 9);
  EXPECT_LT(unfit, 9);
  EXPECT_LT(coloured, 9);
}

TEST(ResidualChecks, FrequenciesShowAManoeuvreThatBearingsDoNot) {
  TargetMotionBatch batch;
  int heard = 0, seen = 0;
  for (std::uint64_t run = 0; run < 20; ++run) {
    RandomStream stream({1, Role::evaluation, run}, StreamId::test);
    BearingWindow bearings;
    DopplerWindow frequencies;
    const Eigen::Vector2d change_mps(0.0, 0.8);
    for (double t = 0.0; t <= testing::KimSong::kEnd_s; t += 7.0) {
      const SensorState own = testing::KimSong::own_ship(t);
      Eigen::Matrix<double, 5, 1> x;
      x << testing::KimSong::target(t), 100.0;
      x.head<2>() += std::max(t - 500.0, 0.0) * change_mps;
      if (t > 500.0) x.segment<2>(2) += change_mps;
      const Eigen::Vector2d z = BearingFrequency<>{own.position_m, own.velocity_mps, 1.0, 1.0}.h(x);
      bearings.add(t, z[0] + radians(1.0) * stream.normal(), radians(1.0), own.position_m);
      frequencies.add(t, z[1] + 0.02 * stream.normal(), 0.02, own);
    }
    const ResidualChecks both =
        check_residuals(bearings, batch.solve(bearings, std::nullopt, nullptr, &frequencies), &frequencies);
    heard += both.manoeuvred && std::abs(both.manoeuvre_s - 500.0) < 150.0;
    seen += check_residuals(bearings, batch.solve(bearings)).manoeuvred;
  }
  EXPECT_GE(heard, 18);
  EXPECT_LE(seen, 5);
}

TEST(ResidualChecks, FindATurnOfThirtyDegreesAndItsTime) {
  const std::string text = R"(
kind = "bearings_only"
period_s = 10
duration_s = 2000
own_ship = { speed_mps = 6, course_deg = 0, turns = [{ time_s = 400, by_deg = 90 }, { time_s = 900, by_deg = -90 },
             { time_s = 1500, by_deg = 90 }] }
target = { range_m = 5000, bearing_deg = 60, course_deg = 300, speed_mps = 5, turns = [{ time_s = 1000, by_deg = 30 }] }
sensor = { bearing_sigma_deg = 0.5 }
)";
  const SharedTable table = parse_toml(text, "turn.toml");
  const auto scenario = read_scenario(TableReader(table, "turn.toml"));
  for (const double share : {0.0, 0.05}) {
    const testing::TmaRates rates = testing::rates_of(*scenario, {.outlier_share = share}, 40, 1);
    EXPECT_GE(rates.manoeuvres, 36);
    int in_time = 0;
    for (const double change_s : rates.change_s) in_time += std::abs(change_s - 1005.0) < 60.0;
    EXPECT_GE(in_time, 32);
  }
}

TEST(ResidualChecks, SayWhichSigmaWouldFit) {
  TargetMotionBatch batch;
  for (const double noise : {0.2, 10.0}) {
    const BearingWindow window = two_legs(kTarget, 300.0, 1200.0, noise);
    const ResidualChecks checks = check_residuals(window, batch.solve(window));
    EXPECT_FALSE(checks.fits);
    EXPECT_EQ(checks.too_small, noise < 1.0);
    EXPECT_NEAR(checks.bearing_sigmas, noise, 0.3 * noise);
    EXPECT_FALSE(checks.manoeuvred);
    EXPECT_TRUE(checks.outliers.empty());
  }
}

TEST(ResidualChecks, OfResidualsThatAreNothingSayNothingOfTheirCorrelation) {
  const BearingWindow window = two_legs(kTarget, 300.0, 1200.0);
  TargetMotionBatch batch;
  const ResidualChecks checks = check_residuals(window, batch.solve(window));
  EXPECT_TRUE(checks.too_small);
  EXPECT_TRUE(std::isnan(checks.lag_one));
}

TEST(ResidualChecks, NoticeAConstantErrorWhereTheGeometryShowsIt) {
  const auto scenario = data_scenario("cho_s1");
  const BearingWindow right = window_of(scenario->simulate({1, Role::evaluation, 0}));
  BearingWindow off;
  for (std::size_t i = 0; i < right.size(); ++i)
    off.add(right.time_s(i), right.bearing_rad(i) + radians(3.0), radians(1.0), right.site_m(i));
  TargetMotionBatch batch;
  const ResidualChecks checks = check_residuals(off, batch.solve(off));
  EXPECT_TRUE(checks.bias.detected);
  EXPECT_NEAR(checks.bias.bias_rad, radians(3.0), 4.0 * checks.bias.sigma_rad);
  EXPECT_FALSE(check_residuals(right, batch.solve(right)).bias.detected);
}

}  // namespace
}  // namespace truebearing::residual_checks_test
