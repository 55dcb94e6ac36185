// SPDX-License-Identifier: Apache-2.0
#include "truebearing/simulation/bearings_only_scenario.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/error_message.hpp"
#include "tests/support/statistics.hpp"
#include "truebearing/core/angle.hpp"

namespace truebearing::bearings_only_scenario_test {
namespace {

using testing::error_message;
using ::testing::HasSubstr;

const std::string kHead = R"(
period_s = 4.0
duration_s = 400.0
own_ship = { speed_mps = 6.0, course_deg = 110.0, turns = [{ time_s = 220.0, to_deg = 350.0 }] }
target = { range_m = 6000.0, bearing_deg = 45.0, course_deg = 290.0, speed_mps = 5.0 }
)";

std::unique_ptr<Scenario> read(const std::string& text) {
  const SharedTable table = parse_toml(text, "bearings.toml");
  TableReader reader(table, "bearings.toml");
  auto scenario = read_bearings_only_scenario(reader);
  reader.finish();
  return scenario;
}

Recording run(const std::string& more, std::uint64_t number = 0) {
  return read(kHead + more)->simulate({1, Role::evaluation, number});
}

TEST(BearingsOnlyScenario, BearingsAreThoseOfTheTargetFromOwnShip) {
  const Recording recording = run("sensor = { bearing_sigma_deg = 1.0 }\n");
  EXPECT_EQ(recording.measured, std::vector<std::string>{"bearing_deg"});
  ASSERT_EQ(recording.measurements.size(), 101u);
  std::vector<double> errors;
  for (std::size_t k = 0; k < recording.measurements.size(); ++k) {
    const Measurement& m = recording.measurements[k];
    const Eigen::Vector2d offset = recording.truth[0].x[k].head<2>() - m.sensor->position_m;
    errors.push_back(wrap_pi(m.z[0] - std::atan2(offset.x(), offset.y())) / radians(1.0));
    EXPECT_EQ(m.sigma[0], radians(1.0));
  }
  EXPECT_TRUE(testing::variance_fits(testing::moments(errors).variance, 1.0, errors.size()));
  const BoundedVector& x0 = recording.truth[0].x.front();
  EXPECT_NEAR(x0[0], 6000.0 * std::sin(radians(45.0)), 1e-9);
  EXPECT_NEAR(x0[2], 5.0 * std::sin(radians(290.0)), 1e-12);
}

TEST(BearingsOnlyScenario, BearingsAreMissingWhileOwnShipTurnsWhereAskedFor) {
  const Recording masked = run("sensor = { bearing_sigma_deg = 1.0, masked_in_turns = true }\n");
  for (const Measurement& m : masked.measurements)
    EXPECT_EQ(m.is_missing(), m.time_s > 220.0 && m.time_s < 260.0) << m.time_s;
  EXPECT_EQ(masked.counts.missing, 9);
  // What is not masked is what it was without the mask.
  const Recording open = run("sensor = { bearing_sigma_deg = 1.0 }\n");
  EXPECT_EQ(masked.measurements.back().z, open.measurements.back().z);
}

TEST(BearingsOnlyScenario, DropoutsAndOutliersComeAtTheirRates) {
  int missing = 0, far = 0, count = 0;
  for (std::uint64_t number = 0; number < 40; ++number) {
    const Recording recording =
        run("sensor = { bearing_sigma_deg = 0.1, dropout_share = 0.2, outlier_share = 0.1, outlier_factor = 100.0 }\n",
            number);
    for (std::size_t k = 0; k < recording.measurements.size(); ++k) {
      const Measurement& m = recording.measurements[k];
      ++count;
      missing += m.is_missing();
      if (m.is_missing()) continue;
      const Eigen::Vector2d offset = recording.truth[0].x[k].head<2>() - m.sensor->position_m;
      far += std::abs(wrap_pi(m.z[0] - std::atan2(offset.x(), offset.y()))) > radians(0.5);
    }
  }
  const double n = count;
  EXPECT_NEAR(missing / n, 0.2, testing::mean_margin(0.4, static_cast<std::size_t>(count)));
  // An outlier of ten degrees is within half a degree with a probability of .04.
  EXPECT_NEAR(far / (n - missing), 0.096, testing::mean_margin(0.3, static_cast<std::size_t>(count)));
}

TEST(BearingsOnlyScenario, FirstMeasurementCarriesTheGuess) {
  std::vector<double> errors;
  for (std::uint64_t number = 0; number < 500; ++number) {
    const Recording recording =
        run("sensor = { bearing_sigma_deg = 1.0 }\nguess = { range_sigma_m = 500.0 }\n", number);
    ASSERT_TRUE(recording.measurements[0].guess);
    EXPECT_FALSE(recording.measurements[1].guess);
    errors.push_back((recording.measurements[0].guess->range_m - 6000.0) / 500.0);
  }
  EXPECT_NEAR(testing::moments(errors).mean, 0.0, testing::mean_margin(1.0, errors.size()));
  EXPECT_TRUE(testing::variance_fits(testing::moments(errors).variance, 1.0, errors.size()));
}

TEST(BearingsOnlyScenario, GuessesStayAboveTheirLeast) {
  for (std::uint64_t number = 0; number < 100; ++number) {
    const Recording recording =
        run("sensor = { bearing_sigma_deg = 1.0 }\n"
            "guess = { range_sigma_m = 9000.0, least_range_m = 600.0, speed_sigma_mps = 5.0, least_speed_mps = 0.3 }\n",
            number);
    EXPECT_GE(recording.measurements[0].guess->range_m, 600.0);
    EXPECT_GE(recording.measurements[0].guess->speed_mps, 0.3);
  }
}

TEST(BearingsOnlyScenario, AcceptsOnlyDrawsThatKeepClear) {
  const std::string text = R"(
period_s = 10.0
duration_s = 1200.0
own_ship = { speed_mps = 5.0, course_deg = { uniform = [0.0, 360.0] } }
target = { range_m = 3000.0, bearing_deg = 0.0, course_deg = { uniform = [0.0, 360.0] }, speed_mps = 5.0 }
sensor = { bearing_sigma_deg = 1.0 }
accept = { closest_m = 2000.0 }
)";
  const auto scenario = read(text);
  for (std::uint64_t number = 0; number < 100; ++number) {
    const Recording recording = scenario->simulate({1, Role::evaluation, number});
    for (std::size_t k = 0; k < recording.measurements.size(); ++k)
      EXPECT_GE((recording.truth[0].x[k].head<2>() - recording.measurements[k].sensor->position_m).norm(), 2000.0);
  }
}

// Without a manoeuvre of own ship no draw determines the range.
TEST(BearingsOnlyScenario, SaysWhereNoDrawIsAccepted) {
  const auto scenario = read(
      "period_s = 10\nduration_s = 600\nown_ship = { speed_mps = 5, course_deg = 0 }\n"
      "target = { range_m = 3000, bearing_deg = { uniform = [0, 360] }, course_deg = 90, speed_mps = 5 }\n"
      "sensor = { bearing_sigma_deg = 1 }\naccept = { range_bound_percent = 25 }\n");
  EXPECT_THAT(error_message([&] { scenario->simulate({1, Role::evaluation, 0}); }), HasSubstr("none of 1000 draws"));
}

TEST(BearingsOnlyScenario, SameKeySameRun) {
  const auto scenario = read(kHead + "sensor = { bearing_sigma_deg = 1.0 }\n");
  const Recording a = scenario->simulate({1, Role::evaluation, 3}), b = scenario->simulate({1, Role::evaluation, 3});
  for (std::size_t k = 0; k < a.measurements.size(); ++k) EXPECT_EQ(a.measurements[k].z, b.measurements[k].z);
  EXPECT_NE(a.measurements[5].z, scenario->simulate({1, Role::training, 3}).measurements[5].z);
}

}  // namespace
}  // namespace truebearing::bearings_only_scenario_test
