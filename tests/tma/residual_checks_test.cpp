#include "truebearing/tma/residual_checks.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/bearing_runs.hpp"
#include "truebearing/tma/bearings_only_batch.hpp"

namespace truebearing {
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
  BearingsOnlyBatch batch;
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
  BearingsOnlyBatch batch;
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
  BearingsOnlyBatch batch;
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
  BearingsOnlyBatch batch;
  EXPECT_FALSE(check_residuals(window, batch.solve(window)).white);
}

}  // namespace
}  // namespace truebearing
