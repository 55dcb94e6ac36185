// SPDX-License-Identifier: Apache-2.0
#include "truebearing/simulation/vessel.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/error_message.hpp"
#include "truebearing/core/angle.hpp"

namespace truebearing::vessel_test {
namespace {

using testing::error_message;
using ::testing::HasSubstr;

VesselParameters read(const std::string& text) {
  const SharedTable table = parse_toml(text, "vessel.toml");
  TableReader reader(table, "vessel.toml");
  VesselParameters vessel = read_vessel(reader);
  reader.finish();
  return vessel;
}

VesselPath sail(const std::string& text, std::uint64_t run = 0) {
  RandomStream stream({1, Role::evaluation, run}, StreamId::scenario);
  return read(text).draw(Eigen::Vector2d::Zero(), stream);
}

TEST(VesselPath, SailsStraightThenAnArcThenStraight) {
  // 90 degrees to starboard at 3 deg/s: 30 s on a circle of radius v / omega.
  const VesselPath path({10.0, 20.0}, 6.0, 0.0, {{100.0, radians(90.0), radians(3.0)}});
  EXPECT_NEAR((path.at(100.0).state.position_m - Eigen::Vector2d(10.0, 620.0)).norm(), 0.0, 1e-9);
  const double radius_m = 6.0 / radians(3.0);
  const VesselPath::State end = path.at(130.0);
  EXPECT_NEAR((end.state.position_m - Eigen::Vector2d(10.0 + radius_m, 620.0 + radius_m)).norm(), 0.0, 1e-9);
  EXPECT_NEAR((end.state.velocity_mps - Eigen::Vector2d(6.0, 0.0)).norm(), 0.0, 1e-12);
  EXPECT_NEAR(path.at(230.0).state.position_m.x(), 10.0 + radius_m + 600.0, 1e-9);
}

TEST(VesselPath, VelocityIsTheSlopeOfThePosition) {
  const VesselPath path({0.0, 0.0}, 5.0, 1.0, {{50.0, -2.0, 0.02}, {120.0, 1.0, 0.01}});
  constexpr double kStep_s = 1e-4;
  for (const double t : {10.0, 60.0, 149.0, 151.0, 200.0, 400.0}) {
    const Eigen::Vector2d slope =
        (path.at(t + kStep_s).state.position_m - path.at(t - kStep_s).state.position_m) / (2.0 * kStep_s);
    EXPECT_LT((slope - path.at(t).state.velocity_mps).norm(), 1e-6) << t;
    EXPECT_NEAR(path.at(t).state.velocity_mps.norm(), 5.0, 1e-12);
  }
}

TEST(VesselPath, TurnsInsideATurnOnly) {
  const VesselPath path({0.0, 0.0}, 5.0, 0.0, {{100.0, radians(-60.0), radians(3.0)}});
  EXPECT_FALSE(path.at(100.0).turning);
  EXPECT_TRUE(path.at(104.0).turning);
  EXPECT_FALSE(path.at(120.0).turning);
}

TEST(VesselPath, ATurnThatComesTooEarlyWaitsForTheOneBefore) {
  const VesselPath path({0.0, 0.0}, 5.0, 0.0,
                        {{100.0, radians(90.0), radians(1.0)}, {120.0, radians(-90.0), radians(1.0)}});
  EXPECT_NEAR(path.at(190.0).state.velocity_mps.x(), 5.0, 1e-9);
  EXPECT_NEAR(path.at(280.0).state.velocity_mps.y(), 5.0, 1e-9);
}

TEST(VesselPath, TellsWhenItTurns) {
  const VesselPath path({0.0, 0.0}, 5.0, 0.0,
                        {{100.0, radians(90.0), radians(1.0)}, {120.0, radians(-45.0), radians(1.0)}});
  ASSERT_EQ(path.turns().size(), 2u);
  EXPECT_EQ(path.turns()[0].begin_s, 100.0);
  EXPECT_NEAR(path.turns()[0].end_s, 190.0, 1e-9);
  EXPECT_EQ(path.turns()[0].change_rad, radians(90.0));
  EXPECT_NEAR(path.turns()[1].begin_s, 190.0, 1e-9) << "it waited";
  EXPECT_NEAR(path.turns()[1].end_s, 235.0, 1e-9);
  EXPECT_EQ(path.first_turn(101.0)->begin_s, 100.0);
  EXPECT_FALSE(path.first_turn(100.0));
  EXPECT_FALSE(VesselPath({0.0, 0.0}, 5.0, 0.0, {}).first_turn(1e9));
}

TEST(Vessel, TurnsToACourseTheShortWay) {
  const VesselPath path =
      sail("speed_mps = 6\ncourse_deg = 110\nturns = [{ time_s = 220, to_deg = 350, rate_degps = 3 }]\n");
  EXPECT_TRUE(path.at(259.0).turning);  // 120 degrees to port: 40 s
  EXPECT_FALSE(path.at(260.0).turning);
  EXPECT_NEAR(path.at(300.0).state.velocity_mps.x(), 6.0 * std::sin(radians(350.0)), 1e-9);
}

TEST(Vessel, TurnsToEitherSideAndSometimesNotAtAll) {
  const std::string text =
      "speed_mps = 6\ncourse_deg = 0\nturns = [{ time_s = 10, by_deg = 40, either_side = true, share = 0.5 }]\n";
  int port = 0, starboard = 0, none = 0;
  for (std::uint64_t run = 0; run < 400; ++run) {
    const double east_mps = sail(text, run).at(1000.0).state.velocity_mps.x();
    (std::abs(east_mps) < 1e-9 ? none : east_mps < 0.0 ? port : starboard)++;
  }
  // Binomial, 200 +- 10 and 100 +- 8.7: five standard deviations.
  EXPECT_NEAR(none, 200, 50);
  EXPECT_NEAR(port, 100, 44);
  EXPECT_NEAR(starboard, 100, 44);
}

TEST(Vessel, MisreadTurnsAreErrors) {
  EXPECT_THAT(error_message([] { read("speed_mps = 6\ncourse_deg = 0\nturns = [{ time_s = 5 }]\n"); }),
              HasSubstr("neither to_deg nor by_deg"));
  EXPECT_THAT(error_message([] {
                read(
                    "speed_mps = 6\ncourse_deg = 0\nturns = [{ time_s = 5, by_deg = 1 }]\n"
                    "random_turns = { first_s = 1, angle_deg = 2 }\n");
              }),
              HasSubstr("stands beside turns"));
  EXPECT_THAT(error_message([] { read("speed_mps = -1\ncourse_deg = 0\n"); }), HasSubstr("speed_mps"));
}

}  // namespace
}  // namespace truebearing::vessel_test
