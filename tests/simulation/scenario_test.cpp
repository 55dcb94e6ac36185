// SPDX-License-Identifier: Apache-2.0
#include "truebearing/simulation/scenario.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <set>
#include <toml++/toml.h>

#include "tests/support/error_message.hpp"
#include "tests/support/statistics.hpp"
#include "truebearing/recording/recording_csv.hpp"

namespace truebearing::scenario_test {
namespace {

using ::testing::AllOf;
using testing::error_message;
using ::testing::HasSubstr;
using testing::mean_margin;
using testing::moments;

std::filesystem::path path_of(const std::string& name) {
  return std::filesystem::path(TRUEBEARING_SOURCE_DIR) / "data/scenarios" / (name + ".toml");
}

std::unique_ptr<Scenario> load(const std::string& name) {
  return load_scenario(path_of(name));
}

std::string error_of(const std::string& text) {
  return error_message([&] {
    const SharedTable table = parse_toml(text, "scenario.toml");
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
                                           "radar_1d_shift_noise", "radar_1d_flight", "manoeuvre_2d", "radar_2d",
                                           "flight_5s", "vessels", "okf_radar", "okf_radar_const_speed"));

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

TEST(Scenario, FlightHasSpeedsAndKinksOfTheStudy) {
  // In the plane, where samples between knots lie on a line exactly.
  toml::table table = *read_toml_file(path_of("radar_1d_flight"));
  table.insert_or_assign("output", "plane");
  const std::unique_ptr<Scenario> flight =
      read_scenario(TableReader(std::make_shared<const toml::table>(std::move(table)), "radar_1d_flight.toml"));
  std::vector<double> interpolated, speeds_mps;
  for (std::uint64_t run = 0; run < 300; ++run) {
    const std::vector<BoundedVector> x = flight->simulate({1, Role::training, run}).truth[0].x;
    speeds_mps.push_back(x[0].tail(2).norm());
    for (std::size_t k = 1; k + 1 < x.size(); ++k)
      interpolated.push_back((x[k + 1] - 2.0 * x[k] + x[k - 1]).head(2).norm() < 1e-6);
  }
  EXPECT_NEAR(moments(speeds_mps).mean, 105.0, mean_margin(110.0 / std::sqrt(12.0), speeds_mps.size()));
  EXPECT_GE(*std::min_element(speeds_mps.begin(), speeds_mps.end()), 50.0);
  EXPECT_LE(*std::max_element(speeds_mps.begin(), speeds_mps.end()), 160.0);
  // Knots come every 1.72 samples on the mean, more evenly than independent draws would.
  constexpr double kShare = 1.0 - 1.0 / 1.72;
  EXPECT_NEAR(moments(interpolated).mean, kShare, mean_margin(std::sqrt(kShare * (1.0 - kShare)), interpolated.size()));
}

TEST(Scenario, FlightComesNearTheSiteAsOftenAsTheStudySays) {
  const auto comes_near = [](const Recording& recording) {
    double closest_m = 1e9;
    for (const BoundedVector& x : recording.truth[0].x) closest_m = std::min(closest_m, x(0));
    return closest_m < 1500.0 ? 1.0 : 0.0;
  };
  // Drawn below 1500 m: all overflights and 1500/20000 of the others. Turning back brings some more near.
  const double drawn = 0.3 + 0.7 * 0.075;
  const double near = over_runs(*load("radar_1d_flight"), 500, comes_near).mean;
  EXPECT_GT(near, drawn - mean_margin(std::sqrt(drawn * (1.0 - drawn)), 500));
  EXPECT_LT(near, 2.0 * drawn);
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
}  // namespace truebearing::scenario_test
