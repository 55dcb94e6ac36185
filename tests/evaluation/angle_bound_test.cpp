// SPDX-License-Identifier: Apache-2.0
#include "truebearing/evaluation/angle_bound.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "tests/support/angle_tracks.hpp"
#include "tests/support/error_message.hpp"
#include "truebearing/array/angle_information.hpp"
#include "truebearing/core/constants.hpp"
#include "truebearing/evaluation/angle_bound_summary.hpp"
#include "truebearing/evaluation/comparison.hpp"
#include "truebearing/evaluation/report.hpp"
#include "truebearing/simulation/line_array_scenario.hpp"

namespace truebearing::angle_bound_test {
namespace {

using testing::error_message;
using ::testing::HasSubstr;

constexpr double kSquareDegree = radians(1.0) * radians(1.0);
constexpr LineArray kArray{15, 0.5};
constexpr int kSnapshots = 30;

// Those targets, each as loud as noise, heard by kArray.
Recording heard(const testing::AnglesOfTracks& angles_deg) {
  Recording recording = testing::angle_recording(angles_deg);
  const std::size_t size = static_cast<std::size_t>(kArray.sensors) * kSnapshots;
  auto values = std::make_shared<std::vector<std::complex<double>>>(size, std::complex<double>(1.0, 0.5));
  for (Measurement& measurement : recording.measurements)
    measurement.snapshots = SnapshotBlock{*values, kArray.sensors, kArray.spacing_wavelengths, 1.0};
  for (Truth& target : recording.truth) target.snr = 1.0;
  recording.snapshots = values;
  return recording;
}

Recording simulated(const std::string& scenario) {
  return load_scenario(std::string(TRUEBEARING_SOURCE_DIR) + "/data/scenarios/" + scenario)->simulate({});
}

double information(double angle_deg) {
  return angle_information(kArray, Eigen::VectorXd::Constant(1, radians(angle_deg)), Eigen::VectorXd::Ones(1),
                           kSnapshots)
      .angles(0, 0);
}

// problems/array-angles.md: A at 0, 5 and 10 dB, its three digits. Steps are scored once both intervals are past that
// begin a track.
TEST(AngleBound, IsThatOfThePrototype) {
  const char* scenarios[] = {"array_a_0db.toml", "array_a_5db.toml", "array_a_10db.toml"};
  const double apart_deg2[] = {0.0350, 0.0106, 0.0033}, posterior_deg2[] = {0.034, 0.0135, 0.0055};
  for (std::size_t i = 0; i < 3; ++i) {
    const AngleVariances run = AngleBound{}.variances(simulated(scenarios[i]), 3);
    const std::vector<AngleBoundSummary> bounds = summarise_angle_bounds({&run});
    EXPECT_NEAR(bounds[0].quantities[0].mse.value, apart_deg2[i], 0.02 * apart_deg2[i]);
    EXPECT_NEAR(bounds[1].quantities[0].mse.value, posterior_deg2[i], 0.02 * posterior_deg2[i]);
  }
}

// Tichavsky's recursion for covariances, which is a Kalman filter's: P <- (P^-1 + H' J H)^-1, P <- F P F' + Q.
TEST(AngleBound, OfOneTargetIsThatOfAKalmanFilter) {
  const AngleBound bound{.q_rad2ps3 = 1e-5, .rate_sigma_radps = 0.05};
  const std::vector<double> angles_deg{10.0, 11.0, 13.0, 16.0};
  const AngleVariances found = bound.variances(heard({{0, angles_deg}}), 2);
  ASSERT_EQ(found.steps(), 4u);
  EXPECT_TRUE(std::isnan(found.posterior_deg2[0])) << "not scored";
  Eigen::Matrix2d F, Q, P;
  F << 1.0, 1.0, 0.0, 1.0;
  Q << 1.0 / 3.0, 0.5, 0.5, 1.0;
  Q *= bound.q_rad2ps3;
  P << 1.0 / information(10.0), 0.0, 0.0, 0.05 * 0.05;
  for (std::size_t k = 1; k < 4; ++k) {
    P = (F * P * F.transpose() + Q).eval();
    const Eigen::Vector2d K = P.col(0) / (P(0, 0) + 1.0 / information(angles_deg[k]));
    P -= (K * P.row(0)).eval();
    EXPECT_NEAR(found.posterior_deg2[k] * kSquareDegree, P(0, 0), 1e-9 * P(0, 0));
    EXPECT_NEAR(found.posterior_deg2ps2[k] * kSquareDegree, P(1, 1), 1e-9 * P(1, 1));
    EXPECT_NEAR(found.cramer_rao_deg2[k] * kSquareDegree * information(angles_deg[k]), 1.0, 1e-9);
    EXPECT_TRUE(found.apart[k]) << "there is no other";
  }
}

TEST(AngleBound, AnotherTargetNearbyCosts) {
  const AngleVariances alone = AngleBound{}.variances(heard({{0, {10, 10}}}), 1);
  const AngleVariances near = AngleBound{}.variances(heard({{0, {10, 10}}, {1, {14, 20.5}}}), 1);
  EXPECT_GT(near.cramer_rao_deg2[0], 1.5 * alone.cramer_rao_deg2[0]);
  EXPECT_GT(near.posterior_deg2[0], 1.2 * alone.posterior_deg2[0]);
  const std::vector<bool> apart{false, true, false, true};
  EXPECT_EQ(near.apart, apart);
}

TEST(AngleBound, WhoIsNotThereIsLeftOut) {
  const Recording both = heard({{0, {10, 10, 10, 10}}, {1, {kNaN, 14, kNaN, kNaN}}});
  const AngleVariances found = AngleBound{}.variances(both, 1);
  const AngleVariances alone = AngleBound{}.variances(heard({{0, {10, 10, 10, 10}}}), 1);
  for (const std::size_t place : {4u, 6u, 7u}) {
    EXPECT_TRUE(std::isnan(found.cramer_rao_deg2[place]));
    EXPECT_TRUE(std::isnan(found.posterior_deg2[place]));
  }
  EXPECT_EQ(found.posterior_deg2[0], alone.posterior_deg2[0]);
  EXPECT_GT(found.posterior_deg2[1], 1.01 * alone.posterior_deg2[1]);
  EXPECT_EQ(found.cramer_rao_deg2[2], alone.cramer_rao_deg2[2]);
  EXPECT_GT(found.posterior_deg2[2], alone.posterior_deg2[2]) << "what the other blurred stays blurred";
  EXPECT_EQ(found.apart[2], true);
  // The newcomer's rate is known no better than before.
  const double rate_deg2ps2 = found.posterior_deg2ps2[5];
  EXPECT_NEAR(rate_deg2ps2, 4.0, 1e-9);
}

TEST(AngleBound, AnIntervalThatIsMissingTellsNothing) {
  Recording recording = heard({{0, {10, 10, 10}}});
  recording.measurements[1].snapshots.reset();
  const AngleVariances found = AngleBound{}.variances(recording, 1);
  EXPECT_TRUE(std::isnan(found.cramer_rao_deg2[1]));
  EXPECT_GT(found.posterior_deg2[1], found.posterior_deg2[0]);
  EXPECT_LT(found.posterior_deg2[2], found.posterior_deg2[1]);
  recording.measurements[0].snapshots.reset();
  const AngleVariances late = AngleBound{}.variances(recording, 1);
  EXPECT_TRUE(std::isnan(late.posterior_deg2[0])) << "nothing was heard yet";
  EXPECT_NEAR(late.posterior_deg2[2], found.posterior_deg2[0], 1e-12);
}

TEST(AngleBound, OtherRecordingsAreRefused) {
  const auto refusal = [](const Recording& recording) {
    return error_message([&] { AngleBound{}.variances(recording, 1); });
  };
  Recording recording = heard({{0, {10, 10}}});
  EXPECT_EQ(refusal(recording), "no error");
  Recording silent = recording;
  silent.truth[0].snr.reset();
  EXPECT_THAT(refusal(silent), HasSubstr("scoring.angle_bound: finds a target in the recording whose signal-to-noise"));
  Recording unknown = recording;
  unknown.truth.clear();
  EXPECT_THAT(refusal(unknown), HasSubstr("truth of angles"));
  recording.measured = {"position_m"};
  EXPECT_THAT(refusal(recording), HasSubstr("snapshots"));
}

TEST(AngleBoundSummary, ByHand) {
  AngleVariances first, second;
  first.targets = 2;
  first.cramer_rao_deg2 = {1.0, 2.0, 3.0, std::numeric_limits<double>::infinity()};
  first.apart = {true, true, true, false};
  first.posterior_deg2 = {kNaN, 1.0, kNaN, 3.0};
  first.posterior_deg2ps2 = {kNaN, 0.5, kNaN, 0.5};
  second = first;
  second.apart = {false, false, false, false};
  second.posterior_deg2 = {kNaN, 5.0, kNaN, kNaN};
  second.posterior_deg2ps2 = {kNaN, 0.2, kNaN, kNaN};
  const std::vector<AngleBoundSummary> bounds = summarise_angle_bounds({&first, &second});
  ASSERT_EQ(bounds.size(), 2u);
  EXPECT_EQ(bounds[0].name, "cramer_rao_apart");
  ASSERT_EQ(bounds[0].quantities.size(), 1u);
  EXPECT_DOUBLE_EQ(bounds[0].quantities[0].mse.value, 2.0);
  EXPECT_EQ(bounds[0].quantities[0].mse.unit, "deg^2");
  EXPECT_DOUBLE_EQ(bounds[0].quantities[0].series[0], std::sqrt(2.0));
  EXPECT_EQ(bounds[1].name, "posterior");
  EXPECT_DOUBLE_EQ(bounds[1].quantities[0].mse.value, 3.0);
  EXPECT_DOUBLE_EQ(bounds[1].quantities[0].rmse, std::sqrt(3.0));
  EXPECT_DOUBLE_EQ(bounds[1].quantities[0].mse.se, 0.5 * (5.0 - 2.0)) << "over runs";
  EXPECT_TRUE(std::isnan(bounds[1].quantities[0].series[0]));
  EXPECT_DOUBLE_EQ(bounds[1].quantities[0].series[1], std::sqrt(3.0));
  EXPECT_DOUBLE_EQ(bounds[1].quantities[1].mse.value, 0.4);
  EXPECT_EQ(bounds[1].quantities[1].mse.name, "rate_mse");
}

Comparison compared(const Recording& first, const Recording& second) {
  Ensemble ensemble;
  ensemble.add("told", testing::told_tracker(testing::AnglesOfTracks{{0, {10, 10, 10, 10}}, {1, {40, 40, 40, 40}}}));
  TrackerSet set(std::move(ensemble));
  set.show_member("told");
  ComparisonOptions options;
  options.runs = 2;
  options.scoring.from_step = 3;
  options.angle_bound = AngleBound{};
  const testing::FakeScenario a(first), b(second);
  return compare(set, {{"apart", &a}, {"close", &b}}, options);
}

TEST(AngleBound, ComesThroughAComparisonOfSets) {
  const Recording apart = heard({{0, {10, 10, 10, 10}}, {1, {40, 40, 40, 40}}});
  const Recording close = heard({{0, {10, 10, 10, 10}}, {1, {15, 15, 15, 15}}});
  const AngleVariances wanted = AngleBound{}.variances(apart, 3);
  const Comparison comparison = compared(apart, close);
  const nlohmann::json report = nlohmann::json::parse(comparison_json(comparison));
  const nlohmann::json& bounds = report["sets"]["apart"]["bounds"];
  const double mse = (wanted.cramer_rao_deg2[2] + wanted.cramer_rao_deg2[6]) / 2.0;
  EXPECT_NEAR(bounds["cramer_rao_apart"]["metrics"][0]["value"].get<double>(), mse, 1e-12);
  EXPECT_NEAR(bounds["cramer_rao_apart"]["angle_deg"].get<double>(), std::sqrt(mse), 1e-12);
  const nlohmann::json& posterior = bounds["posterior"];
  EXPECT_EQ(posterior["metrics"][0]["name"], "mse");
  EXPECT_EQ(posterior["metrics"][0]["unit"], "deg^2");
  EXPECT_EQ(posterior["metrics"][1]["name"], "rate_mse");
  EXPECT_EQ(posterior["metrics"][1]["unit"], "(deg/s)^2");
  EXPECT_EQ(posterior["series"]["time_s"], nlohmann::json({1.0, 2.0, 3.0, 4.0}));
  EXPECT_TRUE(posterior["series"]["rmse"]["angle_deg"][1].is_null());
  EXPECT_NEAR(posterior["series"]["rmse"]["rate_degps"][3].get<double>(),
              std::sqrt((wanted.posterior_deg2ps2[3] + wanted.posterior_deg2ps2[7]) / 2.0), 1e-12);
  EXPECT_TRUE(report["sets"]["close"]["bounds"]["cramer_rao_apart"]["angle_deg"].is_null()) << "nobody is apart";
  EXPECT_NEAR(report["bounds"]["cramer_rao_apart"]["metrics"][0]["value"].get<double>(), mse, 1e-12);
  EXPECT_GT(report["bounds"]["posterior"]["angle_deg"], posterior["angle_deg"]);
  const std::string table = comparison_table(comparison);
  for (const char* text : {"bounds", "cramer_rao_apart", "posterior", "mse deg^2", "rate mse (deg/s)^2"})
    EXPECT_THAT(table, HasSubstr(text));
}

}  // namespace
}  // namespace truebearing::angle_bound_test
