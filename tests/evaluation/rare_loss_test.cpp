// SPDX-License-Identifier: Apache-2.0
#include "truebearing/evaluation/rare_loss.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/support/error_message.hpp"
#include "tests/support/line_trackers.hpp"
#include "truebearing/evaluation/comparison.hpp"
#include "truebearing/evaluation/loss_score.hpp"
#include "truebearing/tracker/raw_tracker.hpp"

namespace truebearing::rare_loss_test {
namespace {

using testing::error_message;
using ::testing::HasSubstr;

// What is measured is published: the last error is that of the sensor, normal with this sigma.
constexpr double kSigma = 1000.0;

LineScenario measured_line() {
  LineParameters parameters;
  parameters.steps = 3;
  parameters.position_m = Distribution(Distribution::Kind::normal, {0.0, 1000.0});
  parameters.velocity_mps = Distribution(0.0);
  parameters.noise = Distribution(kSigma);
  return LineScenario(parameters);
}

TrackerSet raw() {
  Ensemble ensemble;
  ensemble.add("raw", std::make_unique<RawTracker>(state_space_of_components({"position_m"}),
                                                   BoundedVector::Constant(1, kSigma)));
  TrackerSet set(std::move(ensemble));
  set.show_member("raw");
  return set;
}

ScoringRule lost_beyond(double position_m) {
  ScoringRule rule;
  rule.loss_thresholds = {{"position_m", position_m}};
  return rule;
}

double normal_beyond(double sigmas) {
  return std::erfc(sigmas / std::numbers::sqrt2);
}

// The last error of the sensor is beyond 3.8906 sigmas once in ten thousand runs, beyond 4.8916 once in a million.
TEST(RareLoss, IsThatOfANormalErrorFromOneInTenToOneInAMillion) {
  for (const double sigmas : {1.6, 3.2905, 3.8906, 4.8916}) {
    const RareLoss loss = rare_loss(raw(), measured_line(), lost_beyond(sigmas * kSigma),
                                    {.seed = 2, .draws = 1000, .repetitions = 20, .threads = 2, .progress = {}});
    const double exact = normal_beyond(sigmas);
    EXPECT_NEAR(loss.loss_rate.value, exact, 3.5 * loss.loss_rate.se) << sigmas;
    EXPECT_LT(loss.loss_rate.se, 0.5 * exact) << sigmas;
    EXPECT_GE(static_cast<double>(loss.levels.size()), std::floor(-std::log10(exact)));
    EXPECT_EQ(loss.levels.back().score, 1.0);
    for (const RareLoss::Level& level : loss.levels)
      EXPECT_NEAR(level.probability.value, normal_beyond(sigmas * level.score), 3.5 * level.probability.se);
    EXPECT_LE(loss.runs, 21 * 1000 * loss.levels.size());
  }
}

// Intervals of two standard errors hold what is true in most of twenty seeds, and shorter ones do not.
TEST(RareLoss, HasAnHonestStandardErrorAndNoBias) {
  constexpr double kSigmas = 4.8916;
  int covered = 0, covered_by_a_sixth = 0;
  std::vector<double> all;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const RareLoss loss = rare_loss(raw(), measured_line(), lost_beyond(kSigmas * kSigma),
                                    {.seed = seed, .draws = 500, .repetitions = 12, .threads = 2, .progress = {}});
    const double off = std::abs(loss.loss_rate.value - normal_beyond(kSigmas)) / loss.loss_rate.se;
    covered += off < 2.0;
    covered_by_a_sixth += off < 2.0 / 6.0;
    all.insert(all.end(), loss.repetitions.begin(), loss.repetitions.end());
  }
  EXPECT_GE(covered, 16);
  EXPECT_LT(covered_by_a_sixth, 13);
  const auto [mean, se] = mean_of(all);
  EXPECT_LT(se, 0.15 * mean);
  EXPECT_NEAR(mean, normal_beyond(kSigmas), 3.0 * se);
}

TEST(RareLoss, OfAFilterAgreesWithPlainRuns) {
  Ensemble ensemble;
  testing::RadarFilter radar;
  ensemble.add("plain", radar.tracker());
  TrackerSet set(std::move(ensemble));
  set.show_member("plain");
  const LineScenario scenario = testing::radar_family(8);
  ComparisonOptions options;
  options.runs = 30000;
  options.scoring = lost_beyond(5500.0);
  const double plain = compare(set, {{"family", &scenario}}, options).trackers[0].loss_rate;
  const double plain_se = std::sqrt(plain * (1.0 - plain) / 30000.0);
  ASSERT_GT(plain, 5e-4);
  ASSERT_LT(plain, 2e-2);
  const RareLoss loss = rare_loss(set, scenario, options.scoring,
                                  {.seed = 3, .draws = 1000, .repetitions = 20, .threads = 2, .progress = {}});
  EXPECT_NEAR(loss.loss_rate.value, plain, 3.0 * std::hypot(loss.loss_rate.se, plain_se));
  EXPECT_LT(loss.loss_rate.se, 0.3 * plain);
}

TEST(RareLoss, IsTheSameForAnyNumberOfThreads) {
  const auto with = [&](int threads) {
    return rare_loss(raw(), measured_line(), lost_beyond(3.0 * kSigma),
                     {.seed = 5, .draws = 100, .repetitions = 5, .threads = threads, .progress = {}})
        .repetitions;
  };
  EXPECT_EQ(with(1), with(3));
}

TEST(RareLoss, WithoutAThresholdOfTheTrackersIsRefused) {
  ScoringRule rule;
  EXPECT_THAT(error_message([&] { rare_loss(raw(), measured_line(), rule, {}); }),
              HasSubstr("scoring.loss_thresholds: say of no quantity of raw when it is lost"));
  rule.loss_thresholds = {{"velocity_mps", 5.0}};
  EXPECT_THAT(error_message([&] { rare_loss(raw(), measured_line(), rule, {}); }), HasSubstr("of no quantity of raw"));
}

// A coin: the error is 0 or 1 m, or the run has no coin to toss.
class Coin final : public Scenario {
 public:
  explicit Coin(bool tossed) : tossed_(tossed) {}
  Recording simulate(const RunKey& key) const override {
    RandomStream stream(key, StreamId::scenario);
    const double position_m = tossed_ && stream.uniform() < 0.5 ? 1.0 : 0.0;
    Recording recording;
    recording.measured = {"position_m"};
    recording.truth_space = &line_space();
    recording.truth.resize(1);
    recording.truth[0].x.push_back(Eigen::Vector2d(position_m, 0.0));
    recording.measurements.push_back(testing::position(1.0, 0.0));
    return recording;
  }
  const StateSpace& truth_space() const override { return line_space(); }

 private:
  bool tossed_;
};

TEST(RareLoss, ThatCannotBeClimbedToIsRefused) {
  const RareLossOptions few{.seed = 1, .draws = 1000, .repetitions = 2, .threads = 2, .progress = {}};
  EXPECT_THAT(
      error_message([&] { rare_loss(raw(), measured_line(), lost_beyond(30.0 * kSigma), few); }),
      HasSubstr("scoring.loss_thresholds: are passed by raw too rarely to be told, less than once in 10^12 runs"));
  EXPECT_THAT(
      error_message([&] { rare_loss(raw(), Coin(true), lost_beyond(2.0), few); }),
      HasSubstr("scoring.loss_thresholds: cannot be climbed to: the last errors of raw take too few values beyond "
                "0.5 times them"));
  EXPECT_THAT(error_message([&] { rare_loss(raw(), Coin(false), lost_beyond(2.0), few); }),
              HasSubstr("scenario: draws nothing at random: all its runs are one"));
}

TEST(LossScore, IsTheLargestLastErrorOverItsThreshold) {
  const StateSpace& truth = line_space();
  const Scorer scorer(truth, truth);
  ScoringRule rule;
  rule.loss_thresholds = {{"position_m", 10.0}, {"velocity_mps", 2.0}};
  RunScore score;
  scorer.prepare(score, 3, 2);
  score.error = {{1.0, 5.0, kNaN, 1.0, 2.0, 3.0}, {1.0, 1.0, 1.0, 1.0, 9.0, 1.8}};
  EXPECT_DOUBLE_EQ(loss_score(score, scorer, rule), 0.9);
  score.error[0][5] = kInfinity;
  EXPECT_EQ(loss_score(score, scorer, rule), kInfinity);
  score.error[0] = {kNaN, kNaN, kNaN, 1.0, 2.0, 3.0};
  EXPECT_EQ(loss_score(score, scorer, rule), kInfinity) << "a target without any error is lost";
}

}  // namespace
}  // namespace truebearing::rare_loss_test
