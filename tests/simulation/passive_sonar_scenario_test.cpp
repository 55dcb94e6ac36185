// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "tests/support/error_message.hpp"
#include "tests/support/statistics.hpp"
#include "truebearing/core/angle.hpp"
#include "truebearing/simulation/bearings_only_scenario.hpp"

namespace truebearing::passive_sonar_scenario_test {
namespace {

using testing::error_message;
using ::testing::HasSubstr;

const std::string kVessels = R"(
period_s = 7.0
duration_s = 2100.0
own_ship = { speed_mps = 4.0, course_deg = 60.0, turns = [{ time_s = 400.0, to_deg = 0.0, rate_degps = 0.5 }] }
target = { range_m = 7615.8, bearing_deg = 23.2, course_deg = 270.0, speed_mps = 3.0, turns = [
  { time_s = 1500.0, by_deg = 60.0, rate_degps = 0.5 }] }
)";
const std::string kSensor = "sensor = { bearing_sigma_deg = 1.0, frequency_sigma_hz = 0.02 }\n";
const std::string kSource = "source = { frequency_hz = 100.0, changes = [{ time_s = 600.0, to_hz = 130.0 }] }\n";

std::unique_ptr<Scenario> read(const std::string& text, const char* kind = "passive_sonar") {
  const SharedTable table = parse_toml("kind = \"" + std::string(kind) + "\"\n" + text, "sonar.toml");
  return read_scenario(TableReader(table, "sonar.toml"));
}

Recording run(const std::string& text, std::uint64_t number = 0, const char* kind = "passive_sonar") {
  return read(text, kind)->simulate({1, Role::evaluation, number});
}

// f0 (1 - v_r / c) by the rate of change of the range, from positions a moment before and after.
double heard_hz(const Eigen::Vector2d& target_m, const Eigen::Vector2d& target_mps, const SensorState& own_ship,
                double f0_hz, double sound_mps = 1500.0) {
  constexpr double kMoment_s = 1e-3;
  const Eigen::Vector2d offset_m = target_m - own_ship.position_m, v_mps = target_mps - own_ship.velocity_mps;
  const double rate_mps =
      ((offset_m + kMoment_s * v_mps).norm() - (offset_m - kMoment_s * v_mps).norm()) / (2.0 * kMoment_s);
  return f0_hz * (1.0 - rate_mps / sound_mps);
}

TEST(PassiveSonarScenario, FrequenciesAreThoseOfTheSourceWithItsDopplerShift) {
  const Recording recording = run(kVessels + kSensor + kSource);
  EXPECT_EQ(recording.measured, (std::vector<std::string>{"bearing_deg", "frequency_hz"}));
  EXPECT_EQ(recording.truth_space, &plane_frequency_space());
  ASSERT_EQ(recording.measurements.size(), 301u);
  std::vector<double> bearing_errors, frequency_errors;
  for (std::size_t k = 0; k < recording.measurements.size(); ++k) {
    const Measurement& m = recording.measurements[k];
    const BoundedVector& x = recording.truth[0].x[k];
    ASSERT_EQ(x.size(), 5);
    EXPECT_EQ(x[4], m.time_s < 600.0 ? 100.0 : 130.0) << m.time_s;
    const Eigen::Vector2d offset = x.head<2>() - m.sensor->position_m;
    bearing_errors.push_back(wrap_pi(m.z[0] - std::atan2(offset.x(), offset.y())) / radians(1.0));
    frequency_errors.push_back((m.z[1] - heard_hz(x.head<2>(), x.segment<2>(2), *m.sensor, x[4])) / 0.02);
    EXPECT_EQ(m.sigma[0], radians(1.0));
    EXPECT_EQ(m.sigma[1], 0.02);
  }
  for (const auto& errors : {bearing_errors, frequency_errors}) {
    EXPECT_NEAR(testing::moments(errors).mean, 0.0, testing::mean_margin(1.0, errors.size()));
    EXPECT_TRUE(testing::variance_fits(testing::moments(errors).variance, 1.0, errors.size()));
  }
  EXPECT_EQ(recording.counts.missing, 0);
}

TEST(PassiveSonarScenario, SpeedOfSoundIsTheSensors) {
  const auto first_hz = [](const std::string& more) {
    return run(kVessels + "sensor = { bearing_sigma_deg = 1.0, frequency_sigma_hz = 1e-9" + more + " }\n" + kSource);
  };
  for (const auto& [text, sound_mps] : {std::pair("", 1500.0), std::pair(", sound_mps = 340.0", 340.0)}) {
    const Recording recording = first_hz(text);
    const BoundedVector& x = recording.truth[0].x[0];
    const Measurement& m = recording.measurements[0];
    EXPECT_NEAR(m.z[1], heard_hz(x.head<2>(), x.segment<2>(2), *m.sensor, 100.0, sound_mps), 1e-6);
  }
}

TEST(PassiveSonarScenario, AFrequencyAloneMayBeMissing) {
  int unheard = 0, missing = 0, count = 0;
  for (std::uint64_t number = 0; number < 20; ++number) {
    const Recording recording = run(kVessels +
                                        "sensor = { bearing_sigma_deg = 1.0, frequency_sigma_hz = 0.02, "
                                        "dropout_share = 0.1, frequency_dropout_share = 0.3 }\n" +
                                        kSource,
                                    number);
    int gone = 0;
    for (const Measurement& m : recording.measurements) {
      ++count;
      gone += std::isnan(m.z[0]);
      unheard += !std::isnan(m.z[0]) && std::isnan(m.z[1]);
      EXPECT_FALSE(std::isnan(m.z[0]) && !std::isnan(m.z[1])) << "a target that is not seen is not heard";
    }
    EXPECT_EQ(recording.counts.missing, gone) << "what has a bearing is of use";
    missing += gone;
  }
  const auto n = static_cast<std::size_t>(count);
  EXPECT_NEAR(missing / static_cast<double>(n), 0.1, testing::mean_margin(0.3, n));
  EXPECT_NEAR(unheard / static_cast<double>(n), 0.9 * 0.3, testing::mean_margin(0.45, n));
}

TEST(PassiveSonarScenario, IsMaskedInTurnsAsAWhole) {
  const Recording recording = run(
      kVessels + "sensor = { bearing_sigma_deg = 1.0, frequency_sigma_hz = 0.02, masked_in_turns = true }\n" + kSource);
  for (const Measurement& m : recording.measurements)
    EXPECT_EQ(m.z.array().isNaN().all(), m.time_s > 400.0 && m.time_s < 520.0) << m.time_s;
}

// Its draws come after those that a scenario of bearings makes, so that it has the same vessels.
TEST(PassiveSonarScenario, HasTheVesselsOfTheScenarioWithoutASource) {
  const std::string family = R"(
period_s = 7.0
duration_s = 700.0
own_ship = { speed_mps = { uniform = [4, 6] }, course_deg = { uniform = [0, 360] } }
target = { range_m = { uniform = [4e3, 12e3] }, bearing_deg = 10.0, course_deg = { uniform = [0, 360] }, speed_mps = 3.0 }
)";
  const Recording with = run(family + kSensor + "source = { frequency_hz = { uniform = [80, 160] } }\n", 3);
  const Recording without = run(family + "sensor = { bearing_sigma_deg = 1.0 }\n", 3, "bearings_only");
  EXPECT_EQ(with.truth[0].x.back().head<4>(), without.truth[0].x.back());
  EXPECT_EQ(with.measurements.back().sensor->position_m, without.measurements.back().sensor->position_m);
  EXPECT_EQ(with.measurements[0].z[0], without.measurements[0].z[0]);
}

std::unique_ptr<Scenario> data(const std::string& name) {
  return load_scenario(std::string(TRUEBEARING_SOURCE_DIR) + "/data/scenarios/passive_sonar_" + name + ".toml");
}

// problems/passive-sonar.md.
TEST(PassiveSonarScenario, CasesAreThePublishedOnes) {
  const auto levels = [](const Recording& recording) {
    std::vector<double> hz;
    for (const double time_s : {595.0, 602.0, 798.0, 805.0})
      hz.push_back(recording.truth[0].x[static_cast<std::size_t>(time_s / 7.0)][4]);
    return hz;
  };
  const Recording a = data("a")->simulate({}), b = data("b")->simulate({}), small = data("small_jump")->simulate({});
  EXPECT_EQ(levels(a), (std::vector<double>{100.0, 100.0, 100.0, 100.0}));
  EXPECT_EQ(levels(b), (std::vector<double>{100.0, 130.0, 130.0, 100.0}));
  EXPECT_EQ(levels(small), (std::vector<double>{100.0, 100.03, 100.03, 100.0}));
  for (const Recording* recording : {&a, &b, &small}) {
    const BoundedVector& x0 = recording->truth[0].x[0];
    EXPECT_LT((x0.head<4>() - Eigen::Vector4d(3000.0, 7000.0, -3.0, 0.0)).norm(), 1e-9);
    EXPECT_NEAR(recording->measurements[150].sensor->velocity_mps.y(), 4.0, 1e-9) << "North since 520 s";
  }
  EXPECT_EQ(small.measurements.back().time_s, 1050.0);
  EXPECT_EQ(b.measurements.back().time_s, 2100.0);
  EXPECT_EQ(b.truth[0].turns_at_s, 1500.0);
  EXPECT_NEAR(std::atan2(b.truth[0].x[240][2], b.truth[0].x[240][3]), radians(330.0 - 360.0), 1e-9);
}

TEST(PassiveSonarScenario, FamiliesTurnAsTheySay) {
  for (const bool sharp : {false, true}) {
    const auto scenario = data(sharp ? "turns_sharp" : "turns");
    int quiet = 0, sharp_runs = 0;
    for (std::uint64_t number = 0; number < 60; ++number) {
      const Recording recording = scenario->simulate({1, Role::evaluation, number});
      EXPECT_EQ(recording.phases.size(), sharp ? 9u : 6u);
      const std::vector<int>& phase = recording.truth[0].phase;
      const double turns_at_s = *recording.truth[0].turns_at_s;
      quiet += std::isinf(turns_at_s);
      EXPECT_EQ(std::count(phase.begin(), phase.end(), -1), 150) << "up to 1043 s";
      EXPECT_EQ(phase.back() == 5, std::isinf(turns_at_s));
      EXPECT_TRUE(std::isinf(turns_at_s) || (turns_at_s >= 1150.0 && turns_at_s < 1600.0));
      sharp_runs += std::count(phase.begin(), phase.end(), 6) > 0;
    }
    EXPECT_NEAR(quiet, 9, 14) << "binomial, five standard deviations";
    EXPECT_EQ(sharp_runs > 0, sharp);
    EXPECT_LT(sharp_runs, 60 - quiet);
  }
}

// A change of the order in which a scenario draws would show here.
TEST(PassiveSonarScenario, ScenariosOfBearingsDrawWhatTheyAlwaysDrew) {
  const auto scenario =
      load_scenario(std::string(TRUEBEARING_SOURCE_DIR) + "/data/scenarios/bearings_only_observable.toml");
  const Recording recording = scenario->simulate({1, Role::evaluation, 2});
  EXPECT_NEAR(recording.truth[0].x[0][0], -8618.829469891798, 1e-9);
  EXPECT_NEAR(recording.measurements[100].z[0], radians(-113.7221170358196), 1e-12);
}

TEST(PassiveSonarScenario, NeedsASourceAndBearingsOnlyHasNone) {
  EXPECT_THAT(error_message([] { read(kVessels + kSensor); }), HasSubstr("source"));
  EXPECT_THAT(error_message([] { read(kVessels + "sensor = { bearing_sigma_deg = 1.0 }\n" + kSource); }),
              HasSubstr("frequency_sigma_hz"));
  EXPECT_THAT(
      error_message([] { read(kVessels + "sensor = { bearing_sigma_deg = 1.0 }\n" + kSource, "bearings_only"); }),
      HasSubstr("source"));
}

TEST(PassiveSonarScenario, TellsThePhasesOfTheTurn) {
  const std::string phases = "phases = { after_s = [200.0, 500.0], from_s = 1050.0 }\n";
  const Recording recording = run(kVessels + kSensor + kSource + phases);
  ASSERT_EQ(recording.phases.size(), 6u);
  ASSERT_EQ(recording.truth[0].phase.size(), recording.measurements.size());
  EXPECT_EQ(recording.truth[0].turns_at_s, 1500.0);
  std::vector<int> steps(7, 0);
  for (const int phase : recording.truth[0].phase) ++steps[static_cast<std::size_t>(phase + 1)];
  // 7 s: 0 ... 1043, 1050 ... 1498, 1505 ... 1617, 1624 ... 1820, 1827 ... 2100.
  EXPECT_EQ(steps, (std::vector<int>{150, 65, 17, 29, 40, 0, 0}));

  std::string quiet = kVessels;
  quiet.replace(quiet.find("1500.0"), 6, "2100.0");
  const Recording without = run(quiet + kSensor + kSource + phases);
  EXPECT_EQ(without.truth[0].phase.front(), -1);
  EXPECT_EQ(without.phases[static_cast<std::size_t>(without.truth[0].phase.back())], "quiet");
  EXPECT_TRUE(std::isinf(*without.truth[0].turns_at_s));
  EXPECT_TRUE(run(kVessels + kSensor + kSource).truth[0].phase.empty());
}

// The information about [x0, f0] from derivatives by differences, turned into a bound on the position at `at_s`.
double position_bound_m(const Recording& recording, double at_s, bool frequencies) {
  using State = Eigen::Matrix<double, 5, 1>;
  const State truth = recording.truth[0].x.front();
  const State step{1.0, 1.0, 1e-3, 1e-3, 1e-4};
  Eigen::Matrix<double, 5, 5> J = Eigen::Matrix<double, 5, 5>::Zero();
  for (const Measurement& m : recording.measurements) {
    if (m.time_s > at_s) break;
    const auto h = [&](const State& x) {
      const Eigen::Vector2d position_m = x.head<2>() + m.time_s * x.segment<2>(2);
      const Eigen::Vector2d offset_m = position_m - m.sensor->position_m;
      return Eigen::Vector2d(std::atan2(offset_m.x(), offset_m.y()),
                             heard_hz(position_m, x.segment<2>(2), *m.sensor, x[4]));
    };
    for (Eigen::Index row = 0; row < (frequencies ? 2 : 1); ++row) {
      State g;
      for (Eigen::Index i = 0; i < 5; ++i) {
        const State d = step[i] * State::Unit(i);
        g[i] = (h(truth + d)[row] - h(truth - d)[row]) / (2.0 * step[i]) / m.sigma[row];
      }
      J += g * g.transpose();
    }
  }
  if (!frequencies) J(4, 4) = 1.0;
  const Eigen::Matrix<double, 5, 5> P = J.inverse();
  Eigen::Matrix<double, 2, 5> there = Eigen::Matrix<double, 2, 5>::Zero();
  there.leftCols<2>().setIdentity();
  there.middleCols<2>(2) = at_s * Eigen::Matrix2d::Identity();
  return std::sqrt((there * P * there.transpose()).trace());
}

std::string bounded_family(double most_m, double duration_s) {
  return "period_s = 7\nduration_s = " + std::to_string(duration_s) + R"(
own_ship = { speed_mps = 5.0, course_deg = { uniform = [0, 360] }, turns = [{ time_s = 300, by_deg = 90, rate_degps = 0.5 }] }
target = { range_m = { uniform = [4e3, 12e3] }, bearing_deg = 0.0, course_deg = { uniform = [0, 360] }, speed_mps = 4.0, turns = [
  { time_s = 700, by_deg = 90, rate_degps = 1.0 }] }
accept = { position_bound_at_s = 630, position_bound_m = )" +
         std::to_string(most_m) + " }\n";
}

TEST(PassiveSonarScenario, AcceptsOnlyDrawsWhosePositionIsKnownInTime) {
  constexpr double kMost_m = 400.0;
  int known = 0;
  for (std::uint64_t number = 0; number < 40; ++number) {
    const auto drawn = [&](double most_m, double duration_s) {
      return run(bounded_family(most_m, duration_s) + kSensor + kSource, number);
    };
    EXPECT_LT(position_bound_m(drawn(kMost_m, 1000.0), 630.0, true), kMost_m) << number;
    known += position_bound_m(drawn(1e9, 700.0), 630.0, true) < kMost_m;
  }
  EXPECT_GT(known, 0);
  EXPECT_LT(known, 40) << "not all that could be drawn";
}

TEST(PassiveSonarScenario, WithoutASourceBearingsAloneHaveToTellThePosition) {
  for (std::uint64_t number = 0; number < 20; ++number) {
    const Recording recording =
        run(bounded_family(900.0, 1000.0) + "sensor = { bearing_sigma_deg = 1.0 }\n", number, "bearings_only");
    Recording longer = recording;
    for (BoundedVector& x : longer.truth[0].x) {
      x.conservativeResize(5);
      x[4] = 1.0;
    }
    EXPECT_LT(position_bound_m(longer, 630.0, false), 900.0) << number;
  }
}

}  // namespace
}  // namespace truebearing::passive_sonar_scenario_test
