// SPDX-License-Identifier: Apache-2.0
// Figures at given times, through a whole comparison of trackers whose errors are known.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/support/fakes.hpp"
#include "truebearing/core/angle.hpp"
#include "truebearing/evaluation/comparison.hpp"
#include "truebearing/evaluation/report.hpp"
#include "truebearing/evaluation/target_motion_metrics.hpp"
#include "truebearing/simulation/bearings_only_scenario.hpp"

namespace truebearing::timed_comparison_test {
namespace {

using nlohmann::json;
using testing::fake_record;
using testing::FakeTracker;
using ::testing::HasSubstr;

// Own ship from the origin to the North at 5 m/s, to the East from 200 s; the target 5 km away at the start.
BearingsOnlyParameters two_legs() {
  BearingsOnlyParameters parameters;
  parameters.duration_s = 400.0;
  parameters.own_ship.speed_mps = 5.0;
  VesselParameters::Turn turn;
  turn.time_s = 200.0;
  turn.angle_deg = 90.0;
  parameters.own_ship.turns = {turn};
  parameters.target.speed_mps = 2.0;
  parameters.target.course_deg = 200.0;
  parameters.range_m = 5000.0;
  parameters.bearing_deg = 60.0;
  parameters.sensor.sigma_rad = radians(1.0);
  return parameters;
}

// Says that the target of two_legs() is `factor` times as far and fast as it is, whatever it measures.
std::unique_ptr<Tracker> fixed_tracker(double factor, std::optional<double> cost = {}) {
  const VesselPath path({5000.0 * std::sin(radians(60.0)), 5000.0 * std::cos(radians(60.0))}, 2.0, radians(200.0), {});
  const auto say = [=](const Measurement& measurement, std::size_t, FakeTracker::Said& said) {
    const SensorState target = path.at(measurement.time_s).state;
    const Eigen::Vector2d own_ship = measurement.sensor->position_m;
    Eigen::Vector4d x;
    x << own_ship + factor * (target.position_m - own_ship), factor * target.velocity_mps;
    said.records.push_back(fake_record(plane_space(), measurement, x, 1e4 * BoundedMatrix::Identity(4, 4)));
    if (cost) said.records.back().batch = BatchOutcome{*cost, 5, 225, 3};
  };
  return std::make_unique<FakeTracker>(plane_space(), say);
}

Comparison compared(int threads = 1, bool reached = true) {
  Ensemble ensemble;
  ensemble.add("true", fixed_tracker(1.0, 40.0));
  ensemble.add("far", fixed_tracker(1.3, 40.1));
  ensemble.add("diverged", fixed_tracker(1e12));
  TrackerSet set(std::move(ensemble));
  for (const char* name : {"true", "far", "diverged"}) set.show_member(name);
  ComparisonOptions options;
  options.runs = 4;
  options.threads = threads;
  options.scoring.times_s = {100.0, reached ? 400.0 : 4000.0};
  options.scoring.families.push_back(target_motion_metrics());
  options.cramer_rao = TargetMotionBound{};
  options.global_minimum = "true";
  options.pairs = {{"far", "true"}};
  const BearingsOnlyScenario scenario(two_legs());
  Comparison comparison = compare(set, {{"two legs", &scenario}}, options);
  comparison.study = "timed";
  return comparison;
}

// The value of a metric in the JSON, null where there is none.
json value(const json& metrics, const std::string& name, double time_s = -1.0) {
  for (const json& metric : metrics)
    if (metric["name"] == name && (time_s < 0.0 ? !metric.contains("time_s") : metric.value("time_s", -1.0) == time_s))
      return metric["value"];
  return "there is none";
}

TEST(TimedComparison, WrongEstimatesShow) {
  const json report = json::parse(comparison_json(compared()));
  const json &good = report["trackers"]["true"]["metrics"], &far = report["trackers"]["far"]["metrics"];
  EXPECT_NEAR(value(good, "range_error_rmse", 400.0), 0.0, 1e-9);
  EXPECT_EQ(value(good, "time_to_20_percent"), 100.0);
  EXPECT_NEAR(value(far, "range_error_mean", 100.0), 30.0, 1e-9);
  EXPECT_NEAR(value(far, "range_error_mean", 400.0), 30.0, 1e-9);
  EXPECT_NEAR(value(far, "range_error_std", 400.0), 0.0, 1e-9);
  EXPECT_NEAR(value(far, "course_error_rmse", 400.0), 0.0, 1e-9);
  EXPECT_NEAR(value(far, "speed_error_rmse", 400.0), 0.6, 1e-9);
  EXPECT_TRUE(value(far, "time_to_20_percent").is_null());
  EXPECT_EQ(value(far, "missing_share", 400.0), 0.0);
  EXPECT_EQ(value(far, "non_finite_starts"), 3.0);
  EXPECT_EQ(value(far, "iterations"), 5.0);
  EXPECT_EQ(value(far, "global_minimum_share"), 0.0);
  EXPECT_EQ(value(good, "global_minimum_share"), "there is none") << "it is the reference";
  const json& diverged = report["trackers"]["diverged"]["metrics"];
  EXPECT_EQ(value(diverged, "iterations"), "there is none") << "no batch estimator";
  EXPECT_NEAR(value(diverged, "range_error_mean", 400.0).get<double>() / 1e14, 1.0, 1e-9);
}

TEST(TimedComparison, BoundAndEfficiency) {
  const json report = json::parse(comparison_json(compared()));
  const json& bound = report["bounds"]["cramer_rao"];
  const double percent = value(bound["metrics"], "range_error_rmse", 400.0);
  EXPECT_GT(percent, 0.0);
  EXPECT_TRUE(value(bound["metrics"], "range_error_rmse", 100.0).is_null()) << "own ship has not turned yet";
  EXPECT_TRUE(bound["position_m"].is_null()) << "over all times";
  EXPECT_NEAR(value(report["trackers"]["far"]["metrics"], "range_efficiency", 400.0), 30.0 / percent, 1e-9);
  EXPECT_TRUE(value(report["trackers"]["far"]["metrics"], "range_efficiency", 100.0).is_null());
  for (const char* name : {"position_rmse", "velocity_rmse", "course_error_rmse", "speed_error_rmse"})
    EXPECT_GT(value(bound["metrics"], name, 400.0), 0.0) << name;
}

// The same target as a source, of which the trackers know the plane alone.
TEST(TimedComparison, OfPassiveSonarHasTheBoundOnTheFrequencyToo) {
  BearingsOnlyParameters parameters = two_legs();
  parameters.sensor.frequency_sigma_hz = 0.02;
  parameters.source = SourceParameters{};
  VesselParameters::Turn turn;
  turn.time_s = 300.0;
  turn.angle_deg = 30.0;
  parameters.target.turns = {turn};
  Ensemble ensemble;
  ensemble.add("far", fixed_tracker(1.3));
  TrackerSet set(std::move(ensemble));
  set.show_member("far");
  ComparisonOptions options;
  options.runs = 2;
  options.scoring.times_s = {280.0, 400.0};
  options.scoring.families.push_back(target_motion_metrics());
  options.cramer_rao = TargetMotionBound{};
  const BearingsOnlyScenario scenario(parameters);
  const Comparison comparison = compare(set, {{"sonar", &scenario}}, options);
  const json report = json::parse(comparison_json(comparison));
  EXPECT_NEAR(value(report["trackers"]["far"]["metrics"], "range_error_mean", 280.0), 30.0, 1e-9);
  const json& bound = report["bounds"]["cramer_rao"]["metrics"];
  for (const char* name : {"position_rmse", "velocity_rmse", "frequency_rmse"}) {
    EXPECT_GT(value(bound, name, 280.0), 0.0) << name;
    EXPECT_TRUE(value(bound, name, 400.0).is_null()) << "the target has turned";
  }
  EXPECT_THAT(comparison_table(comparison), HasSubstr("cramer_rao"));
  const json plain = json::parse(comparison_json(compared()));
  EXPECT_EQ(value(plain["bounds"]["cramer_rao"]["metrics"], "frequency_rmse", 400.0), "there is none");
}

TEST(TimedComparison, PairsAtTheTimes) {
  const Comparison comparison = compared();
  const json pair = json::parse(comparison_json(comparison))["paired"]["far - true"];
  ASSERT_EQ(pair["at_times"].size(), 4u) << "two quantities at two times";
  EXPECT_EQ(pair["at_times"][1]["quantity"], "position_m");
  EXPECT_EQ(pair["at_times"][1]["time_s"], 400.0);
  EXPECT_NEAR(pair["at_times"][2]["mean"], 0.6, 1e-9);
  EXPECT_NEAR(pair["at_times"][1]["mean"], 0.3 * 3178.8, 0.1) << "of the range at 400 s";
}

TEST(TimedComparison, TableHasTheTimesAndTheBound) {
  const std::string table = comparison_table(compared());
  for (const char* text :
       {"position rmse m", "100 s", "400 s", "range error mean percent", "range efficiency", "cramer_rao",
        "time to 20 percent s", "global minimum share", "e+14", "far - true, position m"})
    EXPECT_THAT(table, HasSubstr(text));
}

TEST(TimedComparison, RunsThatEndBeforeATimeHaveNoFiguresThere) {
  const json report = json::parse(comparison_json(compared(1, false)));
  EXPECT_TRUE(value(report["trackers"]["true"]["metrics"], "position_rmse", 4000.0).is_null());
  EXPECT_TRUE(value(report["bounds"]["cramer_rao"]["metrics"], "position_rmse", 4000.0).is_null());
}

TEST(TimedComparison, IsTheSameForAnyNumberOfThreadsByteForByte) {
  const std::string one = comparison_json(compared(1));
  EXPECT_EQ(comparison_json(compared(2)), one);
  EXPECT_EQ(comparison_json(compared(8)), one);
}

}  // namespace
}  // namespace truebearing::timed_comparison_test
