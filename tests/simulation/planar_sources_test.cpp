// SPDX-License-Identifier: Apache-2.0
// A flight in the plane that several sensors look at, each in its own time.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <toml++/toml.h>

#include <cmath>
#include <memory>
#include <vector>

#include "tests/support/error_message.hpp"
#include "truebearing/core/angle.hpp"
#include "truebearing/simulation/scenario.hpp"

namespace truebearing::planar_sources_test {
namespace {

using ::testing::AllOf;
using testing::error_message;
using ::testing::HasSubstr;

const std::string kFlight = R"(
kind = "planar_flight"
period_s = 1.0
steps = 40
flight = { speed_mps = 100.0, leg_s = 1e5, turn_s = 1.0, turn_rate_degps = 0.0, roll_in_s = 0.0 }
site = { start_east_m = 3000.0, start_north_m = 4000.0 }
)";
const std::string kPlots = "[sensors.plots]\noutput = \"plane\"\nposition_sigma_m = 10.0\nperiod_s = 2.0\n";
const std::string kDoppler = R"(
[sensors.doppler]
output = "range_bearing_rate"
range_sigma_m = 20.0
bearing_sigma_deg = 1.0
range_rate_sigma_mps = 0.5
period_s = 4.0
first_s = 0.5
site_m = [1000.0, -500.0]
bias = [50.0, 2.0, 0.25]
)";

std::unique_ptr<Scenario> scenario_of(const std::string& text) {
  return read_scenario(TableReader(std::make_shared<const toml::table>(toml::parse(text)), "several.toml"));
}

Recording run_of(const std::string& text, std::uint64_t run = 0) {
  return scenario_of(text)->simulate({5, Role::evaluation, run});
}

TEST(PlanarSources, EachLooksInItsOwnTime) {
  const Recording run = run_of(kFlight + kPlots + kDoppler);
  ASSERT_EQ(run.sources.size(), 2u);
  EXPECT_EQ(run.sources[0].name, "doppler");  // in the order of their names
  std::vector<double> doppler_s, plots_s;
  double last_s = 0.0;
  for (const Measurement& one : run.measurements) {
    EXPECT_GE(one.time_s, last_s);
    last_s = one.time_s;
    (one.source == 0 ? doppler_s : plots_s).push_back(one.time_s);
    EXPECT_EQ(one.z.size(), one.source == 0 ? 3 : 2);
  }
  ASSERT_EQ(plots_s.size(), 20u);
  EXPECT_EQ(plots_s.front(), 2.0);
  EXPECT_EQ(plots_s.back(), 40.0);
  ASSERT_EQ(doppler_s.size(), 10u);
  EXPECT_EQ(doppler_s[1], 4.5);
}

// Means over 2000 measurements of each kind are within 4.5 standard errors in all but seven of a million cases each.
TEST(PlanarSources, NoiseBiasAndSiteAreThoseOfEachSensor) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero(), squares = Eigen::Vector3d::Zero();
  double count = 0.0;
  const auto scenario = scenario_of(kFlight + kPlots + kDoppler);
  for (std::uint64_t r = 0; r < 200; ++r) {
    const Recording run = scenario->simulate({5, Role::evaluation, r});
    for (std::size_t k = 0; k < run.measurements.size(); ++k) {
      if (run.measurements[k].source != 0) continue;
      const BoundedVector& x = run.truth[0].x[k];
      const Eigen::Vector2d sight = x.head<2>() - Eigen::Vector2d(1000.0, -500.0);
      const Eigen::Vector3d exact(sight.norm(), std::atan2(sight.x(), sight.y()), x.tail<2>().dot(sight.normalized()));
      Eigen::Vector3d error = run.measurements[k].z - exact;
      error[1] = wrap_pi(error[1]);
      sum += error;
      squares += error.cwiseAbs2();
      count += 1.0;
    }
  }
  ASSERT_EQ(count, 2000.0);
  const Eigen::Vector3d mean = sum / count, sigma(20.0, radians(1.0), 0.5), bias(50.0, radians(2.0), 0.25);
  const Eigen::Vector3d variance = squares / count - mean.cwiseAbs2();
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(mean[i], bias[i], 4.5 * sigma[i] / std::sqrt(count));
    EXPECT_NEAR(variance[i], sigma[i] * sigma[i], 4.5 * sigma[i] * sigma[i] * std::sqrt(2.0 / count));
  }
}

TEST(PlanarSources, ASensorMayMissLooks) {
  int seen = 0;
  const auto scenario = scenario_of(kFlight + kPlots + "missed = 0.3\n");
  for (std::uint64_t r = 0; r < 100; ++r)
    seen += static_cast<int>(scenario->simulate({5, Role::evaluation, r}).measurements.size());
  EXPECT_NEAR(seen, 1400, 4.5 * std::sqrt(2000 * 0.3 * 0.7));
}

TEST(PlanarSources, ARunIsAFunctionOfItsKey) {
  const Recording a = run_of(kFlight + kPlots + kDoppler, 3), b = run_of(kFlight + kPlots + kDoppler, 3);
  ASSERT_EQ(a.measurements.size(), b.measurements.size());
  for (std::size_t k = 0; k < a.measurements.size(); ++k) EXPECT_EQ(a.measurements[k].z, b.measurements[k].z);
  EXPECT_NE(a.measurements[0].z, run_of(kFlight + kPlots + kDoppler, 4).measurements[0].z);
}

TEST(PlanarSources, MistakesSayWhatWouldBeRight) {
  const auto error_of = [](const std::string& text) { return error_message([&] { scenario_of(text); }); };
  std::string no_site = kFlight + kDoppler;
  no_site.erase(no_site.find("site = "),
                std::string("site = { start_east_m = 3000.0, start_north_m = 4000.0 }").size());
  EXPECT_THAT(error_of(no_site), AllOf(HasSubstr("begin at the sensor"), HasSubstr("range_m")));
  EXPECT_THAT(error_of(kFlight + "[sensors]\n"), HasSubstr("[scenario.sensors.NAME]"));
  EXPECT_THAT(error_of(kFlight + "output = \"plane\"\n" + kPlots), HasSubstr("output"));
  EXPECT_THAT(error_of(kFlight + kPlots + "bias = [1.0]\n"), AllOf(HasSubstr("bias"), HasSubstr("2")));
  EXPECT_THAT(error_of(kFlight + "[sensors.line]\noutput = \"range\"\nposition_sigma_m = 1.0\nperiod_s = 1.0\n"),
              AllOf(HasSubstr("range_bearing"), HasSubstr("output")));
}

}  // namespace
}  // namespace truebearing::planar_sources_test
