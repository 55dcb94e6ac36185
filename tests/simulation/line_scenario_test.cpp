// SPDX-License-Identifier: Apache-2.0
#include "truebearing/simulation/line_scenario.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/error_message.hpp"
#include "tests/support/statistics.hpp"

namespace truebearing::line_scenario_test {
namespace {

using ::testing::AllOf;
using testing::error_message;
using ::testing::HasSubstr;
using testing::mean_margin;
using testing::moments;
using testing::variance_fits;

const RunKey kKey{1, Role::evaluation, 0};

LineParameters moving_target() {
  LineParameters parameters;
  parameters.period_s = 2.0;
  parameters.steps = 50;
  parameters.position_m = 100.0;
  parameters.velocity_mps = -7.0;
  parameters.noise = 10.0;
  return parameters;
}

std::vector<double> errors(const Recording& recording) {
  std::vector<double> values;
  for (std::size_t k = 0; k < recording.measurements.size(); ++k)
    values.push_back(recording.measurements[k].z(0) - recording.truth[0].x[k](0));
  return values;
}

std::string error_of(const std::string& text) {
  return error_message([&] {
    const SharedTable table = parse_toml(text, "line.toml");
    TableReader reader(table, "line.toml");
    read_line_scenario(reader);
    reader.finish();
  });
}

TEST(LineScenario, WithoutNoiseTheTargetKeepsItsVelocity) {
  const Recording recording = LineScenario(moving_target()).simulate(kKey);
  EXPECT_EQ(recording.measured, std::vector<std::string>{"position_m"});
  EXPECT_EQ(recording.truth_space, &line_space());
  ASSERT_EQ(recording.measurements.size(), 50u);
  for (int k = 1; k <= 50; ++k) {
    const auto i = static_cast<std::size_t>(k - 1);
    EXPECT_EQ(recording.measurements[i].time_s, 2.0 * k);
    EXPECT_NEAR(recording.truth[0].x[i](0), 100.0 - 7.0 * 2.0 * k, 1e-9);
    EXPECT_EQ(recording.truth[0].x[i](1), -7.0);
  }
}

TEST(LineScenario, MeasurementErrorHasTheVarianceAsked) {
  LineParameters parameters = moving_target();
  parameters.steps = 20'000;
  for (const bool variance : {false, true}) {
    parameters.noise_is_variance = variance;
    const std::vector<double> error = errors(LineScenario(parameters).simulate(kKey));
    const double expected_m2 = variance ? 10.0 : 100.0;
    EXPECT_LT(std::abs(moments(error).mean), mean_margin(std::sqrt(expected_m2), error.size()));
    EXPECT_TRUE(variance_fits(moments(error).variance, expected_m2, error.size()));
    EXPECT_FALSE(variance_fits(moments(error).variance, 1.1 * expected_m2, error.size()));
  }
}

TEST(LineScenario, ProcessNoiseHasTheVarianceAsked) {
  LineParameters parameters = moving_target();
  parameters.steps = 20'000;
  parameters.process_noise_variance << 5.0, 0.1;
  parameters.process_noise_scale = 4.0;
  const std::vector<BoundedVector> x = LineScenario(parameters).simulate(kKey).truth[0].x;
  std::vector<double> position, velocity;
  for (std::size_t k = 1; k < x.size(); ++k) {
    position.push_back(x[k](0) - x[k - 1](0) - 2.0 * x[k - 1](1));
    velocity.push_back(x[k](1) - x[k - 1](1));
  }
  EXPECT_TRUE(variance_fits(moments(position).variance, 20.0, position.size()));
  EXPECT_TRUE(variance_fits(moments(velocity).variance, 0.4, velocity.size()));
  EXPECT_LT(std::abs(moments(velocity).mean), mean_margin(std::sqrt(0.4), velocity.size()));
}

TEST(LineScenario, MeasurementNoiseDoesNotDependOnTheTarget) {
  LineParameters other = moving_target();
  other.process_noise_variance << 5.0, 0.1;
  other.velocity_mps = Distribution(Distribution::Kind::uniform, {-400.0, 400.0});
  const std::vector<double> a = errors(LineScenario(moving_target()).simulate(kKey));
  const std::vector<double> b = errors(LineScenario(other).simulate(kKey));
  for (std::size_t k = 0; k < a.size(); ++k) EXPECT_NEAR(a[k], b[k], 1e-9);
}

TEST(LineScenario, SigmaIsReportedWhereAsked) {
  LineParameters parameters = moving_target();
  EXPECT_EQ(LineScenario(parameters).simulate(kKey).measurements[0].sigma.size(), 0);
  parameters.reported = true;
  EXPECT_EQ(LineScenario(parameters).simulate(kKey).measurements[0].sigma(0), 10.0);
}

TEST(LineScenario, AMixtureDrawsItsVarianceForEachMeasurement) {
  LineParameters parameters = moving_target();
  parameters.steps = 20'000;
  parameters.reported = true;
  parameters.mixture = NoiseMixture{{0.6, 0.4}, {1.5, 0.25}};
  const Recording recording = LineScenario(parameters).simulate(kKey);
  const std::vector<double> all = errors(recording);
  std::vector<double> loud, quiet;
  for (std::size_t k = 0; k < all.size(); ++k) {
    const double sigma_m = recording.measurements[k].sigma(0);
    (sigma_m > 10.0 ? loud : quiet).push_back(all[k]);
    EXPECT_EQ(sigma_m, sigma_m > 10.0 ? 10.0 * std::sqrt(1.5) : 5.0);
  }
  const double share = static_cast<double>(loud.size()) / static_cast<double>(all.size());
  EXPECT_NEAR(share, 0.6, mean_margin(std::sqrt(0.24), all.size()));
  EXPECT_TRUE(variance_fits(moments(loud).variance, 150.0, loud.size()));
  EXPECT_TRUE(variance_fits(moments(quiet).variance, 25.0, quiet.size()));
  EXPECT_FALSE(variance_fits(moments(quiet).variance, 30.0, quiet.size()));
}

TEST(LineScenario, AVelocityIsMeasuredWhereAsked) {
  LineParameters parameters = moving_target();
  parameters.steps = 20'000;
  EXPECT_EQ(LineScenario(parameters).measured(), Measured::position(1));
  parameters.velocity_sigma_mps = 3.0;
  parameters.reported = true;
  const LineScenario scenario(parameters);
  EXPECT_EQ(scenario.measured()->components, (std::vector<std::string>{"position_m", "velocity_mps"}));
  const Recording recording = scenario.simulate(kKey);
  EXPECT_EQ(recording.measured, scenario.measured()->components);
  EXPECT_EQ(recording.measurements[0].sigma, Eigen::Vector2d(10.0, 3.0));
  std::vector<double> velocity;
  for (std::size_t k = 0; k < recording.measurements.size(); ++k)
    velocity.push_back(recording.measurements[k].z(1) - recording.truth[0].x[k](1));
  EXPECT_TRUE(variance_fits(moments(errors(recording)).variance, 100.0, velocity.size()));
  EXPECT_TRUE(variance_fits(moments(velocity).variance, 9.0, velocity.size()));
  EXPECT_FALSE(variance_fits(moments(velocity).variance, 10.0, velocity.size()));
}

TEST(LineScenario, FamilyDrawsOnceForEachRun) {
  LineParameters parameters = moving_target();
  parameters.velocity_mps = Distribution(Distribution::Kind::uniform, {-400.0, 400.0});
  const LineScenario family(parameters);
  std::vector<double> velocities;
  for (std::uint64_t run = 0; run < 2000; ++run)
    velocities.push_back(family.simulate({1, Role::training, run}).truth[0].x[9](1));
  EXPECT_LT(std::abs(moments(velocities).mean), mean_margin(800.0 / std::sqrt(12.0), velocities.size()));
  // The variance of the squared deviation of a uniform of width w is w^4/180.
  EXPECT_NEAR(moments(velocities).variance, 800.0 * 800.0 / 12.0,
              mean_margin(800.0 * 800.0 / std::sqrt(180.0), velocities.size()));
}

TEST(LineScenario, KeysAreChecked) {
  const std::string head = "period_s = 1.0\nsteps = 10\n";
  const std::string target = "[target]\nposition_m = 0.0\nvelocity_mps = 200.0\n";
  EXPECT_EQ(error_of(head + target + "[sensor]\nposition_sigma_m = 1\n"), "no error");
  EXPECT_THAT(error_of(head + target + "[sensor]\nreported = true\n"),
              AllOf(HasSubstr("sensor"), HasSubstr("position_sigma_m or position_variance_m2")));
  EXPECT_THAT(error_of(head + target + "[sensor]\nposition_sigma_m = 1\nposition_variance_m2 = 1\n"),
              HasSubstr("one of two keys"));
  EXPECT_THAT(error_of(head + target + "[sensor]\nposition_sigma_m = -1\n"), HasSubstr("sensor.position_sigma_m"));
  const std::string mixed = head + target + "[sensor]\nposition_sigma_m = 1\nmixture = ";
  EXPECT_EQ(error_of(mixed + "{ shares = [0.6, 0.4], variance_factors = [1.5, 0.2] }\n"), "no error");
  EXPECT_THAT(error_of(mixed + "{ shares = [0.6, 0.5], variance_factors = [1.5, 0.2] }\n"),
              AllOf(HasSubstr("sensor.mixture.shares: do not sum to 1"), HasSubstr("probabilities")));
  EXPECT_THAT(error_of(mixed + "{ shares = [0.6, 0.4], variance_factors = [1.5] }\n"),
              HasSubstr("sensor.mixture.variance_factors: holds 1 numbers"));
  EXPECT_THAT(error_of(mixed + "{ shares = [0.6, 0.4], variance_factors = [1.5, 0.0] }\n"),
              HasSubstr("sensor.mixture.variance_factors: holds 0"));
  EXPECT_THAT(error_of(head + target + "velocty = 1\n[sensor]\nposition_sigma_m = 1\n"),
              AllOf(HasSubstr("target.velocty"), HasSubstr("velocity_mps")));
  EXPECT_THAT(error_of(head + "process_noise_variance = [1, -1]\n" + target), HasSubstr("process_noise_variance"));
  EXPECT_THAT(error_of("period_s = 0\nsteps = 10\n" + target), HasSubstr("period_s"));
  EXPECT_THAT(error_of("period_s = 1\nsteps = 10.5\n" + target), HasSubstr("an integer in"));
}

}  // namespace
}  // namespace truebearing::line_scenario_test
