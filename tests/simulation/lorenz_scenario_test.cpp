// SPDX-License-Identifier: Apache-2.0
#include "truebearing/simulation/lorenz_scenario.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/error_message.hpp"
#include "tests/support/statistics.hpp"

namespace truebearing::lorenz_scenario_test {
namespace {

using testing::error_message;
using ::testing::HasSubstr;
using testing::mean_margin;
using testing::moments;
using testing::variance_fits;

const RunKey kKey{1, Role::evaluation, 0};

LorenzParameters coarse() {
  LorenzParameters parameters;
  parameters.steps = 400;
  parameters.truth = LorenzMotion<LorenzRungeKutta>{{}, 0.005};
  parameters.sigma = 0.5;
  return parameters;
}

std::string error_of(const std::string& text) {
  return error_message([&] {
    const SharedTable table = parse_toml(text, "lorenz.toml");
    TableReader reader(table, "lorenz.toml");
    read_lorenz_scenario(reader);
    reader.finish();
  });
}

constexpr const char* kText = R"(
period_s = 0.02
steps = 10
truth = { model = "lorenz_taylor", terms = 5, step_s = 1e-3 }
start = { x = 1.0, y = 1.0, z = 1.0 }
sensor = { sigma = 1.0 }
)";

TEST(LorenzScenario, IsTheMotionSeenEveryPeriod) {
  const Recording recording = LorenzScenario(coarse()).simulate(kKey);
  ASSERT_EQ(recording.measurements.size(), 400u);
  EXPECT_EQ(recording.truth_space, &lorenz_space());
  EXPECT_EQ(recording.measured, lorenz_space().components);
  const LorenzMotion<LorenzRungeKutta> motion{{}, 0.005};
  Eigen::Vector3d x(1.0, 1.0, 1.0);
  for (std::size_t k = 0; k < 20; ++k) {
    x = motion.f(x, 0.02);
    EXPECT_NEAR(recording.measurements[k].time_s, 0.02 * static_cast<double>(k + 1), 1e-12);
    EXPECT_LT((recording.truth[0].x[k] - x).norm(), 1e-9);
  }
}

TEST(LorenzScenario, RunsOfAFixedStartDifferInTheirNoiseAlone) {
  const LorenzScenario scenario(coarse());
  const Recording one = scenario.simulate(kKey), other = scenario.simulate({1, Role::evaluation, 1});
  EXPECT_EQ(one.truth[0].x.back(), other.truth[0].x.back());
  EXPECT_NE(one.measurements.back().z, other.measurements.back().z);
}

TEST(LorenzScenario, DrawnStartsAreTrajectoriesOfTheirOwn) {
  LorenzParameters parameters = coarse();
  parameters.start = {Distribution(Distribution::Kind::normal, {1.0, 1.0}), 1.0, 1.0};
  parameters.burn_in_s = 20.0;
  const LorenzScenario scenario(parameters);
  EXPECT_GT((scenario.simulate(kKey).truth[0].x[0] - scenario.simulate({1, Role::evaluation, 1}).truth[0].x[0]).norm(),
            0.1);
}

TEST(LorenzScenario, NoisesAreThoseAskedFor) {
  LorenzParameters parameters = coarse();
  parameters.process_sigma = 0.2;
  parameters.rotation = rotation_of({1.0, 2.0, 3.0});
  const Recording recording = LorenzScenario(parameters).simulate(kKey);
  std::vector<double> measured, moved;
  const LorenzMotion<LorenzRungeKutta> motion{{}, 0.005};
  for (std::size_t k = 1; k < recording.truth[0].x.size(); ++k) {
    const Eigen::Vector3d x = recording.truth[0].x[k], before = recording.truth[0].x[k - 1];
    const Eigen::Vector3d v = recording.measurements[k].z - parameters.rotation * x, w = x - motion.f(before, 0.02);
    measured.insert(measured.end(), v.begin(), v.end());
    moved.insert(moved.end(), w.begin(), w.end());
  }
  EXPECT_NEAR(moments(measured).mean, 0.0, mean_margin(0.5, measured.size()));
  EXPECT_TRUE(variance_fits(moments(measured).variance, 0.25, measured.size()));
  EXPECT_TRUE(variance_fits(moments(moved).variance, 0.04, moved.size()));
}

TEST(LorenzScenario, LeadsByTheStateToCome) {
  LorenzParameters parameters = coarse();
  const Recording now = LorenzScenario(parameters).simulate(kKey);
  parameters.lead_steps = 1;
  const Recording ahead = LorenzScenario(parameters).simulate(kKey);
  ASSERT_EQ(ahead.measurements.size(), 400u);
  for (std::size_t k = 0; k + 1 < 400; ++k) {
    EXPECT_EQ(ahead.truth[0].x[k], now.truth[0].x[k + 1]);
    EXPECT_EQ(ahead.measurements[k].z, now.measurements[k].z);
  }
}

TEST(LorenzScenario, RotationTurnsAboutXThenYThenZ) {
  EXPECT_LT((rotation_of({90.0, 0.0, 0.0}) * Eigen::Vector3d::UnitY() - Eigen::Vector3d::UnitZ()).norm(), 1e-12);
  EXPECT_LT((rotation_of({90.0, 0.0, 90.0}) * Eigen::Vector3d::UnitX() - Eigen::Vector3d::UnitY()).norm(), 1e-12);
  EXPECT_LT((rotation_of({0.0, 90.0, 90.0}) * Eigen::Vector3d::UnitZ() - Eigen::Vector3d::UnitY()).norm(), 1e-12);
}

TEST(LorenzScenario, SaysWhatIsWrong) {
  const std::string text = kText;
  const auto with = [&](const std::string& from, const std::string& to) {
    return error_of(std::string(text).replace(text.find(from), from.size(), to));
  };
  EXPECT_EQ(error_of(text), "no error");
  EXPECT_THAT(with("lorenz_taylor", "taylor"), HasSubstr("truth.model"));
  EXPECT_THAT(with("terms = 5", "terms = 0"), HasSubstr("truth.terms"));
  EXPECT_THAT(with("step_s = 1e-3", "step_s = 1e-7"), HasSubstr("truth.step_s"));
  EXPECT_THAT(with(", z = 1.0", ""), HasSubstr("start"));
  EXPECT_THAT(with("sigma = 1.0", "sigma = 1.0, rotation_deg = [1.0]"), HasSubstr("sensor.rotation_deg"));
  EXPECT_THAT(with("steps = 10", "steps = 10\nlead_steps = -1"), HasSubstr("lead_steps"));
}

}  // namespace
}  // namespace truebearing::lorenz_scenario_test
