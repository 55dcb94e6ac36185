// SPDX-License-Identifier: Apache-2.0
// What smoothers are held to. Fewer runs than the bars are meant for: two standard errors are allowed on top.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <memory>
#include <string>
#include <utility>

#include "tests/support/comparisons.hpp"
#include "truebearing/filter/filter_state.hpp"
#include "truebearing/filter/interacting_multiple_model.hpp"
#include "truebearing/filter/kalman.hpp"
#include "truebearing/motion/constant_velocity.hpp"
#include "truebearing/tracker/filter_tracker.hpp"
#include "truebearing/tracker/position_sensor.hpp"
#include "truebearing/tracker/smoothing_tracker.hpp"

namespace truebearing::smoothing_test {
namespace {

using testing::load_study;

Comparison run(const std::string& name, std::size_t runs) {
  const Study study = load_study(name);
  ComparisonOptions options = study.comparison_options();
  options.runs = runs;
  options.seed = 20;
  return compare(study.make_tracker_set(), study.evaluation_scenarios(), options);
}

TEST(Smoothing, OfAMultipleModelIsAQuarterBetterThanTheFilter) {
  const Comparison comparison = run("manoeuvre_2d_smoothed", 30);
  const PairedDifference found = testing::difference(comparison, "imm6_smoothed", "imm6", "position_m");
  EXPECT_LT(found.mean + 2.0 * found.se, -0.25 * comparison.tracker("imm6")->quantity("position_m")->rmse);
  for (const char* quantity : {"position_m", "velocity_mps"}) {
    testing::expect_better(comparison, "tuned_smoothed", "tuned", quantity);
    testing::expect_better(comparison, "imm6_lag_10", "imm6", quantity);
  }
}

TEST(Smoothing, OfTheSingerFilterIsThePublishedOne) {
  const Comparison comparison = run("benchmark_zhenbiny_smoothed", 100);
  const QuantitySummary& position = *comparison.tracker("singer_smoothed")->quantity("position_m");
  EXPECT_LT(position.rmse, 53.0 + 2.0 * position.rmse_se);
}

TEST(Smoothing, TeachesAtLeastHalfOfWhatTheTruthDoes) {
  const Comparison comparison = run("manoeuvre_2d_no_truth", 100);
  const auto rmse = [&](const char* tracker, const char* quantity) {
    return comparison.tracker(tracker)->quantity(quantity)->rmse;
  };
  for (const char* quantity : {"position_m", "velocity_mps"}) {
    for (const char* blind : {"nfnn_no_truth", "nfnn_guess"})
      EXPECT_GT(rmse("tuned", quantity) - rmse(blind, quantity),
                0.5 * (rmse("tuned", quantity) - rmse("nfnn", quantity)))
          << blind << ", " << quantity;
    EXPECT_GT(rmse("imm6", quantity) - rmse("imm6_nfnn_no_truth", quantity),
              0.5 * (rmse("imm6", quantity) - rmse("imm6_nfnn", quantity)))
        << quantity;
  }
}

// Targets drawn from the models themselves: their prior, their chain, the noise of their modes.
struct Model {
  std::array<double, 2> sigma_a_mps2;
  MarkovChain chain = star_chain(2, 0.05, 0.1, 1.0, 1.0);
  double sigma_m = 50.0, prior_m = 1000.0, prior_mps = 100.0;

  PriorStart prior() const {
    const Eigen::Vector4d variance(prior_m * prior_m, prior_m * prior_m, prior_mps * prior_mps, prior_mps * prior_mps);
    return {Eigen::Vector4d::Zero(), variance.asDiagonal().toDenseMatrix(), 0.0};
  }
  std::unique_ptr<FilterTracker> tracker(std::unique_ptr<TrackedState> state) const {
    return std::make_unique<FilterTracker>(plane_space(), std::move(state),
                                           sensor_of(PositionSensor<2>{{sigma_m, sigma_m}}), prior());
  }
  std::unique_ptr<TrackedState> mode(std::size_t i) const {
    return state_of<KalmanFilter<4>>(ConstantVelocity<2, DiscreteWhiteNoise>{{sigma_a_mps2[i]}});
  }
  std::unique_ptr<FilterTracker> single() const { return tracker(mode(0)); }
  std::unique_ptr<FilterTracker> multiple() const {
    InteractingMultipleModel::Modes modes;
    modes.push_back(mode(0));
    modes.push_back(mode(1));
    return tracker(std::make_unique<InteractingMultipleModel>(std::move(modes), chain));
  }
};

class DrawnFromModels final : public Scenario {
 public:
  explicit DrawnFromModels(const Model& model) : model_(model) {}
  const StateSpace& truth_space() const override { return plane_space(); }

  Recording simulate(const RunKey& key) const override {
    RandomStream random(key, StreamId::test);
    Recording recording;
    recording.measured = Measured::position(2).components;
    recording.truth_space = &plane_space();
    recording.truth.resize(1);
    Eigen::Vector4d x(random.normal(), random.normal(), random.normal(), random.normal());
    x.head<2>() *= model_.prior_m;
    x.tail<2>() *= model_.prior_mps;
    Eigen::Index mode = random.uniform() < model_.chain.initial[0] ? 0 : 1;
    for (int k = 1; k <= 60; ++k) {
      mode = random.uniform() < model_.chain.transition(mode, 0) ? 0 : 1;
      const double sigma = model_.sigma_a_mps2[static_cast<std::size_t>(mode)];
      const double east = sigma * random.normal(), north = sigma * random.normal();
      const Eigen::Vector2d a(east, north);
      x.head<2>() += x.tail<2>() + 0.5 * a;
      x.tail<2>() += a;
      const double noise_east = random.normal(), noise_north = random.normal();
      Measurement measurement;
      measurement.time_s = k;
      measurement.z = x.head<2>() + model_.sigma_m * Eigen::Vector2d(noise_east, noise_north);
      recording.measurements.push_back(measurement);
      recording.truth[0].x.emplace_back(x);
    }
    return recording;
  }

 private:
  Model model_;
};

constexpr std::size_t kMatchedRuns = 1000;

// The NEES of trackers made of `believed` on targets of `true_model`: "kf", "imm", and their smoothers.
Comparison on_drawn_targets(const Model& true_model, const Model& believed) {
  Ensemble ensemble;
  ensemble.add("kf", believed.single());
  ensemble.add("imm", believed.multiple());
  ensemble.add("kf_smoothed", std::make_unique<SmoothingTracker>(believed.single()));
  ensemble.add("imm_smoothed", std::make_unique<SmoothingTracker>(believed.multiple()));
  TrackerSet set(std::move(ensemble));
  for (const char* name : {"kf", "imm", "kf_smoothed", "imm_smoothed"}) set.show_member(name);
  const DrawnFromModels scenario(true_model);
  ComparisonOptions options;
  options.runs = kMatchedRuns;
  options.seed = 3;
  options.pairs = {{"kf_smoothed", "kf"}, {"imm_smoothed", "imm"}, {"imm_smoothed", "kf_smoothed"}};
  return compare(set, {{"drawn", &scenario}}, options);
}

// Mean of a run's NEES: its variance is at most that of one step, 2 n, however its steps hang together. Four of its
// standard errors: chance breaks it once in 16000.
bool is_consistent(const Comparison& comparison, const std::string& tracker) {
  return std::abs(comparison.tracker(tracker)->nees - 4.0) < 4.0 * std::sqrt(8.0 / double(kMatchedRuns));
}

TEST(Smoothing, OfTargetsThatFollowOneModelIsAsSureAsItMayBe) {
  const Model same{{5.0, 5.0}};
  const Comparison comparison = on_drawn_targets(same, same);
  for (const char* tracker : {"kf", "imm", "kf_smoothed", "imm_smoothed"})
    EXPECT_TRUE(is_consistent(comparison, tracker)) << tracker << " " << comparison.tracker(tracker)->nees;
  testing::expect_better(comparison, "kf_smoothed", "kf", "position_m");
}

TEST(Smoothing, OfTargetsThatChangeTheirModelIsAsSureAsItMayBe) {
  const Model two{{2.0, 40.0}};
  const Comparison comparison = on_drawn_targets(two, two);
  for (const char* tracker : {"imm", "imm_smoothed"})
    EXPECT_TRUE(is_consistent(comparison, tracker)) << tracker << " " << comparison.tracker(tracker)->nees;
  testing::expect_better(comparison, "imm_smoothed", "imm", "position_m");
  testing::expect_better(comparison, "imm_smoothed", "kf_smoothed", "position_m");
}

// The partner: models that are not the targets' show.
TEST(Smoothing, OfOtherTargetsItIsNot) {
  const Comparison sure = on_drawn_targets({{2.0, 40.0}}, {{2.0, 10.0}});
  const Comparison timid = on_drawn_targets({{2.0, 10.0}}, {{5.0, 60.0}});
  for (const char* tracker : {"imm", "imm_smoothed"}) {
    EXPECT_GT(sure.tracker(tracker)->nees, 4.0);
    EXPECT_FALSE(is_consistent(sure, tracker)) << tracker << " " << sure.tracker(tracker)->nees;
    EXPECT_LT(timid.tracker(tracker)->nees, 4.0);
    EXPECT_FALSE(is_consistent(timid, tracker)) << tracker << " " << timid.tracker(tracker)->nees;
  }
}

}  // namespace
}  // namespace truebearing::smoothing_test
