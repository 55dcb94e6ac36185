// SPDX-License-Identifier: Apache-2.0
#include "truebearing/simulation/space_flight_scenario.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/error_message.hpp"
#include "tests/support/statistics.hpp"
#include "truebearing/core/angle.hpp"
#include "truebearing/measurement/sight_in_space.hpp"

namespace truebearing::space_flight_scenario_test {
namespace {

using testing::error_message;
using ::testing::HasSubstr;
using testing::mean_margin;
using testing::moments;
using testing::variance_fits;

constexpr const char* kText = R"(
output = "range_bearing_elevation_rate"
period_s = 0.5
steps = 400
flight = { speed_mps = 70.0, leg_s = 20.0, turn_s = 20.0, turn_rate_degps = 6.0, roll_in_s = 2.0 }
climb = { level_s = 20.0, climb_s = 15.0, climb_mps = { uniform = [5.0, 20.0] }, acceleration_mps2 = 3.0 }
start = { east_m = { normal = [0.0, 4000.0] }, north_m = { normal = [0.0, 4000.0] }, up_m = 3000.0 }
sensor = { range_sigma_m = 10.0, bearing_sigma_deg = 1.0, elevation_sigma_deg = 3.0, range_rate_sigma_mps = 5.0, range_rate_correlation = 0.6 }
)";

std::unique_ptr<Scenario> scenario(const std::string& text) {
  const SharedTable table = parse_toml(text, "space.toml");
  TableReader reader(table, "space.toml");
  std::unique_ptr<Scenario> made = read_space_flight_scenario(reader);
  reader.finish();
  return made;
}

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  return text.replace(text.find(what), what.size(), by);
}

TEST(SpaceFlightScenario, IsAFunctionOfTheKey) {
  const auto one = scenario(kText);
  const Recording a = one->simulate({1, Role::evaluation, 3}), b = one->simulate({1, Role::evaluation, 3});
  const Recording other = one->simulate({1, Role::evaluation, 4});
  EXPECT_EQ(a.measured, (std::vector<std::string>{"range_m", "bearing_deg", "elevation_deg", "range_rate_mps"}));
  EXPECT_EQ(a.truth_space, &space_space());
  ASSERT_EQ(a.measurements.size(), 400u);
  for (std::size_t k = 0; k < a.measurements.size(); ++k) {
    EXPECT_EQ(a.measurements[k].z, b.measurements[k].z);
    EXPECT_EQ(a.truth[0].x[k], b.truth[0].x[k]);
  }
  EXPECT_NE(a.truth[0].x[0], other.truth[0].x[0]);
}

TEST(SpaceFlightScenario, VelocitiesAreTheDerivativesOfPositionsAndClimbsAreBounded) {
  const Recording recording = scenario(kText)->simulate({2, Role::evaluation, 0});
  const std::vector<BoundedVector>& x = recording.truth[0].x;
  double highest_mps = 0.0;
  for (std::size_t k = 1; k + 1 < x.size(); ++k) {
    EXPECT_LT(((x[k + 1] - x[k - 1]).head<3>() - x[k].tail<3>()).norm(), 2.5) << k;
    EXPECT_LE(std::abs(x[k][5] - x[k - 1][5]), 3.0 * 0.5 + 1e-9) << k;
    EXPECT_NEAR(x[k].segment<2>(3).norm(), 70.0, 1e-9);
    highest_mps = std::max(highest_mps, std::abs(x[k][5]));
  }
  EXPECT_GT(highest_mps, 5.0 - 1e-9);
  EXPECT_LE(highest_mps, 20.0);
}

TEST(SpaceFlightScenario, NoiseHasItsMomentsAndItsCorrelation) {
  const auto one = scenario(kText);
  std::vector<std::vector<double>> errors(4);
  std::vector<double> products;
  for (std::uint64_t run = 0; run < 20; ++run) {
    const Recording recording = one->simulate({3, Role::evaluation, run});
    for (std::size_t k = 0; k < recording.measurements.size(); ++k) {
      const BoundedVector& x = recording.truth[0].x[k];
      const SightInSpace<double> sight(x.head<3>());
      const BoundedVector& z = recording.measurements[k].z;
      const double e[] = {(z[0] - sight.range_m) / 10.0, wrap_pi(z[1] - sight.bearing_rad) / radians(1.0),
                          (z[2] - sight.elevation_rad) / radians(3.0), (z[3] - sight.range_rate(x.tail<3>())) / 5.0};
      for (std::size_t i = 0; i < 4; ++i) errors[i].push_back(e[i]);
      products.push_back(e[0] * e[3]);
    }
  }
  for (const std::vector<double>& component : errors) {
    EXPECT_LT(std::abs(moments(component).mean), mean_margin(1.0, component.size()));
    EXPECT_TRUE(variance_fits(moments(component).variance, 1.0, component.size()));
  }
  // The product of two such has a variance of 1 + rho^2.
  EXPECT_LT(std::abs(moments(products).mean - 0.6), mean_margin(std::sqrt(1.36), products.size()));
}

TEST(SpaceFlightScenario, MeasuresPositionsAndAnglesToo) {
  const std::string sensor = std::string(kText).substr(std::string(kText).find("sensor ="));
  const std::string output = "output = \"range_bearing_elevation_rate\"";
  const std::string position = replaced(
      replaced(kText, sensor, "sensor = { position_sigma_m = 30.0, reported = true }"), output, "output = \"space\"");
  const Recording at = scenario(position)->simulate({4, Role::evaluation, 0});
  EXPECT_EQ(at.measured, (std::vector<std::string>{"east_m", "north_m", "up_m"}));
  EXPECT_EQ(at.measurements[0].sigma, BoundedVector(Eigen::Vector3d::Constant(30.0)));
  EXPECT_LT((at.measurements[0].z - at.truth[0].x[0].head<3>()).norm(), 300.0);
  const std::string angles =
      replaced(replaced(kText, sensor, "sensor = { bearing_sigma_deg = 0.1, elevation_sigma_deg = 0.1 }"), output,
               "output = \"bearing_elevation\"");
  EXPECT_EQ(scenario(angles)->simulate({4, Role::evaluation, 0}).measured,
            (std::vector<std::string>{"bearing_deg", "elevation_deg"}));
}

// From the ship, whose place the measurement carries; the truth is where it was without it.
TEST(SpaceFlightScenario, AShipCarriesTheSensor) {
  const std::string ship = "own_ship = { speed_mps = 15.0, course_deg = 90.0 }\n";
  const Recording still = scenario(kText)->simulate({5, Role::evaluation, 0});
  const Recording carried = scenario(ship + kText)->simulate({5, Role::evaluation, 0});
  for (std::size_t k = 0; k < still.measurements.size(); ++k) {
    ASSERT_EQ(carried.truth[0].x[k], still.truth[0].x[k]);
    ASSERT_TRUE(carried.measurements[k].sensor);
    EXPECT_NEAR(carried.measurements[k].sensor->position_m.x(), 15.0 * 0.5 * double(k), 1e-9);
    EXPECT_FALSE(still.measurements[k].sensor);
    BoundedVector x = still.truth[0].x[k];
    const SightInSpace<double> from_land(x.head<3>());
    const double rate_from_land = from_land.range_rate(x.tail<3>());
    x[0] -= 15.0 * 0.5 * double(k);
    x[3] -= 15.0;
    const SightInSpace<double> from_ship(x.head<3>());
    const BoundedVector difference = carried.measurements[k].z - still.measurements[k].z;
    EXPECT_NEAR(difference[0], from_ship.range_m - from_land.range_m, 1e-6);
    EXPECT_NEAR(wrap_pi(difference[1] - from_ship.bearing_rad + from_land.bearing_rad), 0.0, 1e-9);
    EXPECT_NEAR(difference[2], from_ship.elevation_rad - from_land.elevation_rad, 1e-9);
    EXPECT_NEAR(difference[3], from_ship.range_rate(x.tail<3>()) - rate_from_land, 1e-6);
  }
}

TEST(SpaceFlightScenario, SaysWhatIsWrong) {
  const auto error_of = [](const std::string& what, const std::string& by) {
    return error_message([&] { scenario(replaced(kText, what, by)); });
  };
  EXPECT_THAT(error_of("\"range_bearing_elevation_rate\"", "\"range\""), HasSubstr("output"));
  EXPECT_THAT(error_of("range_rate_correlation = 0.6", "range_rate_correlation = 1.0"),
              HasSubstr("range_rate_correlation"));
  EXPECT_THAT(error_of("up_m = 3000.0", "height_m = 3000.0"), HasSubstr("up_m"));
  const std::string sensor = std::string(kText).substr(std::string(kText).find("sensor ="));
  const std::string ship = "own_ship = { speed_mps = 15.0, course_deg = 90.0 }\n";
  EXPECT_THAT(error_of(sensor, ship + "sensor = { position_sigma_m = 30.0 }"), HasSubstr("sensor"));
  EXPECT_THAT(error_message([&] {
                scenario(replaced(replaced(kText, sensor, ship + "sensor = { position_sigma_m = 30.0 }"),
                                  "\"range_bearing_elevation_rate\"", "\"space\""));
              }),
              HasSubstr("own_ship"));
  EXPECT_THAT(error_of("acceleration_mps2 = 3.0", "acceleration_mps2 = 0.0"), HasSubstr("acceleration_mps2"));
}

}  // namespace
}  // namespace truebearing::space_flight_scenario_test
