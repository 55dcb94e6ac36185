// SPDX-License-Identifier: Apache-2.0
// What `truebearing tma` says is wrong with a log, and in which order.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fmt/format.h>
#include <functional>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/app/program.hpp"
#include "tests/support/bearing_runs.hpp"
#include "truebearing/recording/recording_csv.hpp"

namespace truebearing::tma_verdict_test {
namespace {

using nlohmann::json;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using testing::Outcome;
using testing::run;
using testing::TemporaryFolder;

// One of Cho's runs as a log, each measurement changed.
std::string changed_log(const std::function<void(std::size_t, Measurement&)>& change) {
  Recording recording = testing::data_scenario("cho_s1")->simulate({5, Role::evaluation, 0});
  for (std::size_t k = 0; k < recording.measurements.size(); ++k) change(k, recording.measurements[k]);
  return write_recording(recording);
}

json answer_of(const std::string& log) {
  const TemporaryFolder folder;
  folder.write("log.csv", log);
  return json::parse(run(folder, "tma log.csv --json -").out);
}

std::string kind_of_first(const json& answer) {
  return answer["causes"].empty() ? "" : answer["causes"][0]["kind"].get<std::string>();
}

TEST(TmaVerdict, OfALogWithoutAFaultNamesNone) {
  EXPECT_EQ(kind_of_first(answer_of(changed_log([](std::size_t, Measurement&) {}))), "");
}

TEST(TmaVerdict, AConstantErrorIsNamedBeforeAManoeuvreThatFitsNoBetter) {
  for (const double bias_deg : {2.0, 5.0, 8.0}) {
    const TemporaryFolder folder;
    folder.write("log.csv", changed_log([&](std::size_t, Measurement& m) { m.z[0] += radians(bias_deg); }));
    const json answer = json::parse(run(folder, "tma log.csv --json -").out);
    EXPECT_EQ(kind_of_first(answer), "bearing_bias") << bias_deg;
    EXPECT_NEAR(answer["bearing_bias"]["estimate_deg"].get<double>(), bias_deg,
                4.0 * answer["bearing_bias"]["standard_deviation_deg"].get<double>());
    EXPECT_THAT(run(folder, "tma log.csv").out, AllOf(Not(HasSubstr("Try --to")), Not(HasSubstr("CHANGED ITS"))));
  }
}

TEST(TmaVerdict, OfAManoeuvreNamesNoConstantErrorFirst) {
  const TemporaryFolder folder;
  folder.write("turn.toml", testing::kTurningTarget);
  ASSERT_EQ(run(folder, "simulate turn.toml -o logs").status, 0);
  EXPECT_EQ(kind_of_first(json::parse(run(folder, "tma logs/run_0000.csv --json -").out)), "manoeuvre");
}

TEST(TmaVerdict, APositionThatJumpsIsNamedWithItsLines) {
  const json answer = answer_of(changed_log([](std::size_t k, Measurement& m) {
    if (k > 100) m.sensor->position_m.x() += 50000.0;
  }));
  EXPECT_EQ(kind_of_first(answer), "own_ship");
  EXPECT_THAT(answer["verdict"].get<std::string>(), AllOf(HasSubstr("line 102"), HasSubstr("line 103")));
  for (const json& cause : answer["causes"]) EXPECT_NE(cause["kind"], "back_bearings");
}

TEST(TmaVerdict, PositionsInAnotherUnitThanTheVelocityAreNamed) {
  for (const auto& [factor, unit] : {std::pair(1e-3, "kilometres"), std::pair(1.0 / 1852.0, "nautical miles")}) {
    const double scale = factor;
    const json answer = answer_of(changed_log([&](std::size_t, Measurement& m) { m.sensor->position_m *= scale; }));
    EXPECT_EQ(kind_of_first(answer), "own_ship") << unit;
    EXPECT_THAT(answer["verdict"].get<std::string>(), HasSubstr(unit));
  }
  const json in_knots =
      answer_of(changed_log([](std::size_t, Measurement& m) { m.sensor->velocity_mps *= 3600.0 / 1852.0; }));
  EXPECT_THAT(in_knots["verdict"].get<std::string>(), HasSubstr("knots"));
}

TEST(TmaVerdict, PositionsThatAreUncertainAreNoJumps) {
  RandomStream stream({1, Role::evaluation, 0}, StreamId::test);
  const json answer = answer_of(changed_log([&](std::size_t, Measurement& m) {
    m.sensor->position_m += 15.0 * Eigen::Vector2d(stream.normal(), stream.normal());
  }));
  for (const json& cause : answer["causes"]) EXPECT_NE(cause["kind"], "own_ship");
}

// A second target that is elsewhere, in the bearings that `of_other` says.
std::string log_of_two(const std::function<bool(std::size_t)>& of_other) {
  const Eigen::Vector4d other(-6000.0, 3000.0, 3.0, 4.0);
  RandomStream stream({2, Role::evaluation, 0}, StreamId::test);
  return changed_log([&](std::size_t k, Measurement& m) {
    if (!of_other(k) || m.is_missing()) return;
    const Eigen::Vector2d d = other.head<2>() + m.time_s * other.tail<2>() - m.sensor->position_m;
    m.z[0] = std::atan2(d.x(), d.y()) + radians(1.0) * stream.normal();
  });
}

TEST(TmaVerdict, TwoContactsAreNamedBeforeLargerNoiseAndOutliers) {
  for (const std::size_t every : {2u, 3u, 5u}) {
    const json answer = answer_of(log_of_two([&](std::size_t k) { return k % every == 0; }));
    EXPECT_EQ(kind_of_first(answer), "two_contacts") << every;
    for (const json& cause : answer["causes"]) EXPECT_NE(cause["kind"], "noise_larger") << every;
  }
}

TEST(TmaVerdict, OneContactAfterAnotherIsNoReversal) {
  const json answer = answer_of(log_of_two([](std::size_t k) { return k >= 450; }));
  for (const json& cause : answer["causes"]) EXPECT_NE(cause["kind"], "back_bearings");
}

TEST(TmaVerdict, OptionsThatTheMethodTakesNoNoticeOfAreRefused) {
  const TemporaryFolder folder;
  folder.write("log.csv", changed_log([](std::size_t, Measurement&) {}));
  for (const auto& [arguments, option] :
       {std::pair("--range 5000 --range-sigma 500", "--range"), std::pair("--velocity-sigma 3", "--velocity-sigma"),
        std::pair("--huber 2 --method levenberg", "--huber")}) {
    const Outcome outcome = run(folder, fmt::format("tma log.csv {}", arguments));
    EXPECT_EQ(outcome.status, 1) << arguments;
    EXPECT_TRUE(testing::is_one_line(outcome.err)) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr(option));
  }
  EXPECT_EQ(run(folder, "tma log.csv --method map --range 5000 --range-sigma 500 --velocity-sigma 3").status, 0);
}

TEST(TmaVerdict, ColumnsOfManyFiguresStayApart) {
  const TemporaryFolder folder;
  folder.write("log.csv", changed_log([](std::size_t, Measurement&) {}));
  const std::string out = run(folder, "tma log.csv --sigma 1e-9").out;
  const std::size_t at = out.find("North m");
  std::istringstream row(out.substr(at + 7, out.find('\n', at) - at - 7));
  std::vector<std::string> cells;
  for (std::string cell; row >> cell;) cells.push_back(cell);
  EXPECT_EQ(cells.size(), 3u) << out;
}

}  // namespace
}  // namespace truebearing::tma_verdict_test
