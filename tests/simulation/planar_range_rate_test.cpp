// SPDX-License-Identifier: Apache-2.0
// Range rates of sensors in the plane: alone, with a range, and with a correlation of the two.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/error_message.hpp"
#include "tests/support/statistics.hpp"
#include "truebearing/simulation/planar_sensor.hpp"

namespace truebearing::planar_range_rate_test {
namespace {

using testing::error_message;
using ::testing::HasSubstr;
using testing::mean_margin;
using testing::moments;
using testing::variance_fits;

const Eigen::Vector4d kState(3000.0, 4000.0, 20.0, -30.0);
constexpr double kRangeRate_mps = 0.6 * 20.0 - 0.8 * 30.0;

PlanarSensor sensor(const std::string& output, const std::string& text) {
  const SharedTable table = parse_toml(text, "sensor.toml");
  return read_planar_sensor(TableReader(table, "sensor.toml"), output);
}

TEST(PlanarRangeRate, IsMeasuredAloneAndWithARange) {
  RandomStream random({81, Role::evaluation, 0}, StreamId::test);
  const PlanarSensor alone = sensor("range_rate", "range_rate_sigma_mps = 1e-6");
  EXPECT_NEAR(alone.measure(0.0, kState, 0.0, random).z[0], kRangeRate_mps, 1e-4);
  EXPECT_EQ(alone.measured().components, std::vector<std::string>{"range_rate_mps"});
  const PlanarSensor both = sensor("range_range_rate", "range_sigma_m = 1e-6\nrange_rate_sigma_mps = 1e-6");
  const BoundedVector z = both.measure(0.0, kState, 1e-6, random).z;
  EXPECT_LT((z - Eigen::Vector2d(5000.0, kRangeRate_mps)).norm(), 1e-4);
}

TEST(PlanarRangeRate, ErrsWithTheRangeAsMuchAsItIsTold) {
  constexpr int kDraws = 20'000;
  RandomStream random({82, Role::evaluation, 0}, StreamId::test);
  const PlanarSensor radar = sensor("range_bearing_rate",
                                    "range_sigma_m = 50.0\nbearing_sigma_deg = 0.3\nrange_rate_sigma_mps = 2.0\n"
                                    "range_rate_correlation = -0.7");
  std::vector<double> rates, products;
  for (int i = 0; i < kDraws; ++i) {
    const BoundedVector z = radar.measure(0.0, kState, 50.0, random).z;
    const double e = (z[0] - 5000.0) / 50.0, f = (z[2] - kRangeRate_mps) / 2.0;
    rates.push_back(f);
    products.push_back(e * f);
  }
  EXPECT_TRUE(variance_fits(moments(rates).variance, 1.0, kDraws));
  EXPECT_LT(std::abs(moments(rates).mean), mean_margin(1.0, kDraws));
  EXPECT_LT(std::abs(moments(products).mean + 0.7), mean_margin(std::sqrt(1.49), kDraws));
}

TEST(PlanarRangeRate, HasACorrelationWithARangeAlone) {
  EXPECT_THAT(error_message([] { sensor("range_rate", "range_rate_sigma_mps = 1.0\nrange_rate_correlation = 0.5"); }),
              HasSubstr("range_rate_correlation"));
  EXPECT_THAT(error_message([] {
                sensor("range_range_rate",
                       "range_sigma_m = 1.0\nrange_rate_sigma_mps = 1.0\nrange_rate_correlation = 1");
              }),
              HasSubstr("range_rate_correlation"));
}

}  // namespace
}  // namespace truebearing::planar_range_rate_test
