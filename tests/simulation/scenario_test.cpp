#include "truebearing/simulation/scenario.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <set>

#include "tests/support/error_message.hpp"
#include "tests/support/statistics.hpp"
#include "truebearing/measurement/recording_csv.hpp"

namespace truebearing {
namespace {

using ::testing::AllOf;
using testing::error_message;
using ::testing::HasSubstr;
using testing::mean_margin;
using testing::moments;

std::unique_ptr<Scenario> load(const std::string& name) {
  return load_scenario(std::filesystem::path(TRUEBEARING_SOURCE_DIR) / "data/scenarios" / (name + ".toml"));
}

std::string error_of(const std::string& text) {
  return error_message([&] {
    const toml::table table = parse_toml(text, "scenario.toml");
    read_scenario(TableReader(table, "scenario.toml"));
  });
}

/// The mean over runs of a number of each.
template <typename Number>
testing::Moments over_runs(const Scenario& scenario, std::uint64_t runs, const Number& number) {
  std::vector<double> values;
  for (std::uint64_t run = 0; run < runs; ++run) values.push_back(number(scenario.simulate({1, Role::training, run})));
  return moments(values);
}

double log_noise_variance(const Recording& recording) {
  double sum = 0.0;
  for (std::size_t k = 0; k < recording.measurements.size(); ++k)
    sum += std::pow(recording.measurements[k].z(0) - recording.truth[0].x[k](0), 2);
  return std::log(sum / static_cast<double>(recording.measurements.size()));
}

class ScenarioFile : public ::testing::TestWithParam<const char*> {};

TEST_P(ScenarioFile, RunIsAFunctionOfItsKey) {
  const std::unique_ptr<Scenario> scenario = load(GetParam());
  const RunKey key{3, Role::validation, 8};
  EXPECT_EQ(write_recording(scenario->simulate(key)), write_recording(load(GetParam())->simulate(key)));
}

TEST_P(ScenarioFile, SeedRoleAndRunSeparate) {
  const std::unique_ptr<Scenario> scenario = load(GetParam());
  std::set<std::string> logs;
  for (const std::uint64_t seed : {1ULL, 2ULL})
    for (const Role role : {Role::tuning, Role::training, Role::validation, Role::evaluation})
      for (const std::uint64_t run : {0ULL, 1ULL}) logs.insert(write_recording(scenario->simulate({seed, role, run})));
  EXPECT_EQ(logs.size(), 16u);
}

INSTANTIATE_TEST_SUITE_P(All, ScenarioFile,
                         ::testing::Values("radar_1d_paper", "radar_1d_family", "radar_1d_shift_speed",
                                           "radar_1d_shift_noise", "radar_1d_flight"));

TEST(Scenario, PaperIsTheTargetOfThePaper) {
  const Recording recording = load("radar_1d_paper")->simulate({});
  ASSERT_EQ(recording.measurements.size(), 240u);
  EXPECT_EQ(recording.measurements[239].time_s, 240.0);
  EXPECT_NEAR(recording.truth[0].x[239](0), 48000.0, 1e-9);
  EXPECT_EQ(recording.measurements[0].sigma.size(), 0);
}

TEST(Scenario, FamilyHasTheSpreadOfTheStudy) {
  const std::unique_ptr<Scenario> family = load("radar_1d_family");
  const auto velocity = [](const Recording& recording) { return recording.truth[0].x[0](1); };
  // The first step adds process noise of at most .4 (m/s)^2 to 400^2/3.
  EXPECT_NEAR(over_runs(*family, 1000, velocity).variance, 400.0 * 400.0 / 3.0,
              mean_margin(800.0 * 800.0 / std::sqrt(180.0), 1000));
  const testing::Moments noise = over_runs(*family, 1000, log_noise_variance);
  // Log-uniform over a factor 16, plus the chi-square error of 240 measurements: variance 2/240, mean about -1/240.
  const double variance = std::pow(std::log(16.0), 2) / 12.0 + 2.0 / 240.0;
  EXPECT_NEAR(noise.mean, std::log(1e7) - 1.0 / 240.0, mean_margin(std::sqrt(variance), 1000));
  EXPECT_NEAR(over_runs(*load("radar_1d_shift_noise"), 1000, log_noise_variance).mean - noise.mean, std::log(16.0),
              1e-9);
}

TEST(Scenario, ShiftOfSpeedIsToSixHundredEitherWay) {
  const std::unique_ptr<Scenario> shifted = load("radar_1d_shift_speed");
  const auto away = [](const Recording& recording) { return recording.truth[0].x[0](1) > 0.0 ? 1.0 : 0.0; };
  EXPECT_NEAR(over_runs(*shifted, 1000, away).mean, 0.5, mean_margin(0.5, 1000));
  EXPECT_NEAR(std::abs(shifted->simulate({}).truth[0].x[0](1)), 600.0, 5.0 * std::sqrt(0.4));
}

TEST(Scenario, FlightHasSpeedsRangesAndKinksOfTheStudy) {
  const std::unique_ptr<Scenario> flight = load("radar_1d_flight");
  int straight = 0, inner = 0, near = 0;
  constexpr int kRuns = 300;
  for (std::uint64_t run = 0; run < kRuns; ++run) {
    const std::vector<BoundedVector> x = flight->simulate({1, Role::training, run}).truth[0].x;
    double closest_m = 1e9;
    for (std::size_t k = 0; k < x.size(); ++k) {
      EXPECT_LE(std::abs(x[k](1)), 160.0);
      closest_m = std::min(closest_m, x[k](0));
      if (k == 0 || k + 1 == x.size()) continue;
      ++inner;
      straight += std::abs(x[k + 1](0) - 2.0 * x[k](0) + x[k - 1](0)) < 5.0;
    }
    near += closest_m < 1500.0;
  }
  // At least the overflights (30 % of them) and the 5 % of the others that are drawn below 1500 m come near.
  EXPECT_GT(near, kRuns * 0.3);
  EXPECT_LT(near, kRuns * 0.8);
  // Samples between knots, 1 - 1/1.72 of all, are nearly straight in range too; the kinks are not.
  EXPECT_GT(straight, inner * 0.3);
  EXPECT_LT(straight, inner * 0.7);
}

TEST(Scenario, UnknownKindListsTheValidOnes) {
  EXPECT_THAT(error_of("kind = \"lin\""), AllOf(HasSubstr("scenario.toml:1: kind"), HasSubstr("line, planar_flight")));
  EXPECT_THAT(error_of("steps = 1"), HasSubstr("kind: is missing"));
}

TEST(Scenario, UnknownKeyIsAnError) {
  EXPECT_THAT(error_of("kind = \"line\"\nperiod_s = 1\nsteps = 1\nstep = 2\n[target]\nposition_m = 0\nvelocity_mps = "
                       "0\n[sensor]\nposition_sigma_m = 1\n"),
              AllOf(HasSubstr("scenario.toml:4: step"), HasSubstr("did you mean \"steps\"")));
}

TEST(Scenario, MissingFileIsAnError) {
  EXPECT_THAT(error_message([] { load_scenario("/nonexistent/s.toml"); }), HasSubstr("/nonexistent/s.toml"));
}

}  // namespace
}  // namespace truebearing
