// SPDX-License-Identifier: Apache-2.0
#include "truebearing/simulation/planar_legs_scenario.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/error_message.hpp"
#include "tests/support/statistics.hpp"
#include "truebearing/core/angle.hpp"

namespace truebearing::planar_legs_scenario_test {
namespace {

using testing::error_message;
using ::testing::HasSubstr;

const std::string kHead = R"(period_s = 5.0
target = { position_m = [25000.0, 10000.0], velocity_mps = [-120.0, 0.0] }
)";
const std::string kSensor = "sensor = { position_sigma_m = 100.0 }\n";

std::unique_ptr<Scenario> read(const std::string& text) {
  const SharedTable table = parse_toml(text, "legs.toml");
  TableReader reader(table, "legs.toml");
  auto scenario = read_planar_legs_scenario(reader);
  reader.finish();
  return scenario;
}

Recording fly(const std::string& legs, const std::string& sensor = kSensor) {
  return read(kHead + sensor + legs)->simulate({1, Role::evaluation, 0});
}

TEST(PlanarLegs, StraightTurnAndStraightAreExact) {
  const Recording recording = fly(
      "legs = [ { duration_s = 125, phase = \"straight\" }, { duration_s = 90, turn_rate_degps = 1, phase = \"turn\" }, "
      "{ duration_s = 125, phase = \"straight\" } ]\n");
  const std::vector<BoundedVector>& x = recording.truth[0].x;
  ASSERT_EQ(x.size(), 69u);
  EXPECT_EQ(recording.phases, (std::vector<std::string>{"straight", "turn"}));
  EXPECT_LT((x[25] - Eigen::Vector4d(10000.0, 10000.0, -120.0, 0.0)).norm(), 1e-9);
  // West, then 90 degrees to starboard: North. A quarter of a circle of radius v / w.
  const double radius_m = 120.0 / radians(1.0);
  EXPECT_LT((x[43] - Eigen::Vector4d(10000.0 - radius_m, 10000.0 + radius_m, 0.0, 120.0)).norm(), 1e-6);
  EXPECT_LT((x[68] - Eigen::Vector4d(10000.0 - radius_m, 10000.0 + radius_m + 15000.0, 0.0, 120.0)).norm(), 1e-6);
  for (std::size_t k = 0; k < x.size(); ++k) {
    EXPECT_EQ(recording.measurements[k].time_s, 5.0 * static_cast<double>(k));
    EXPECT_NEAR(x[k].tail(2).norm(), 120.0, 1e-9);
    EXPECT_EQ(recording.truth[0].phase[k], k > 25 && k <= 43 ? 1 : 0) << k;
  }
}

TEST(PlanarLegs, AccelerationIsIntegratedExactly) {
  const Recording recording = fly("legs = [ { duration_s = 100, acceleration_mps2 = [0.5, -0.25] } ]\n");
  const BoundedVector& x = recording.truth[0].x.back();
  EXPECT_LT((x - Eigen::Vector4d(25000.0 - 12000.0 + 2500.0, 10000.0 - 1250.0, -70.0, -25.0)).norm(), 1e-9);
  EXPECT_TRUE(recording.truth[0].phase.empty());
}

TEST(PlanarLegs, ErrorsHaveTheCovarianceGiven) {
  const std::string sensor = "sensor = { position_covariance_m2 = [10000.0, 5000.0, 5000.0, 10000.0] }\n";
  const Recording recording = fly("legs = [ { duration_s = 100000 } ]\n", sensor);
  std::vector<double> products, squares;
  for (std::size_t k = 0; k < recording.measurements.size(); ++k) {
    const Eigen::Vector2d e = recording.measurements[k].z - recording.truth[0].x[k].head(2);
    products.push_back(e[0] * e[1]);
    squares.push_back(e[0]);
  }
  const testing::Moments product = testing::moments(products);
  EXPECT_NEAR(product.mean, 5000.0, testing::mean_margin(std::sqrt(product.variance), products.size()));
  EXPECT_TRUE(testing::variance_fits(testing::moments(squares).variance, 1e4, squares.size()));
}

TEST(PlanarLegs, KeysAreChecked) {
  const auto error_of = [](const std::string& text) { return error_message([&] { read(text); }); };
  const std::string legs = "legs = [ { duration_s = 10 } ]\n";
  EXPECT_EQ(error_of(kHead + kSensor + legs), "no error");
  EXPECT_THAT(error_of(kHead + kSensor), HasSubstr("legs"));
  EXPECT_THAT(error_of(kHead + kSensor + "legs = [ { duration_s = 10, turn_rate = 1 } ]\n"),
              HasSubstr("turn_rate_degps"));
  EXPECT_THAT(
      error_of(kHead + kSensor + "legs = [ { duration_s = 10, turn_rate_degps = 1, acceleration_mps2 = [1, 1] } ]\n"),
      HasSubstr("one of them"));
  EXPECT_THAT(error_of(kHead + kSensor + "legs = [ { duration_s = 10, phase = \"a\" }, { duration_s = 5 } ]\n"),
              HasSubstr("phase"));
  EXPECT_THAT(error_of(kHead + legs + "sensor = { position_covariance_m2 = [1, 2, 2, 1] }\n"),
              HasSubstr("positive definite"));
}

}  // namespace
}  // namespace truebearing::planar_legs_scenario_test
