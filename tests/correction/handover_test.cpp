// SPDX-License-Identifier: Apache-2.0
// A correction that may trust another tracker in its reference's place, where that lately foretold better.
#include <gtest/gtest.h>

#include "tests/support/correction_models.hpp"
#include "tests/support/line_trackers.hpp"
#include "truebearing/correction/correction.hpp"
#include "truebearing/correction/limit_kappa.hpp"

namespace truebearing::handover_test {
namespace {

using testing::line_model;
using testing::position;
using testing::RadarFilter;
using testing::shared;

// A filter that believes in a velocity that hardly changes, and one that follows.
RadarFilter filter(double velocity_noise_variance) {
  RadarFilter made;
  made.variance = {1e4, 1e4};
  made.noise_variance = {1.0, velocity_noise_variance};
  made.sigma_m = 50.0;
  return made;
}

FuzzyNetwork::Parameters zeros() {
  return {.input_mean = Eigen::VectorXd::Zero(1),
          .input_scale = Eigen::VectorXd::Ones(1),
          .input_clip = 4.0,
          .centres = Eigen::MatrixXd::Zero(1, 1),
          .widths = Eigen::MatrixXd::Ones(1, 1),
          .consequents = Eigen::MatrixXd::Zero(1, 2),
          .output_scale = Eigen::VectorXd::Ones(2)};
}

// A target whose velocity swings between -150 and 150 m/s within a minute, measured every second to 50 m; the last
// record of a correction by nothing.
StepRecord after_swings(double reference_noise, double fallback_noise, std::vector<StepRecord>* trusted = nullptr) {
  Ensemble ensemble;
  ensemble.add("reference", filter(reference_noise).tracker());
  ensemble.add("fallback", filter(fallback_noise).tracker());
  CorrectionBounds bounds;
  bounds.referee = RefereeOptions{};
  bounds.fallback = "fallback";
  Correction correction(shared(line_model({{.kind = FeatureKind::residual, .component = "position_m"}}, zeros(),
                                          "reference", "reference", "reference")),
                        ensemble, bounds);
  RandomStream random({.seed = 3}, StreamId::test);
  StepRecord last;
  for (int k = 1; k <= 300; ++k) {
    const double swing = 2.0 * kPi * k / 60.0;
    ensemble.step(position(k, -150.0 * 60.0 / (2.0 * kPi) * std::cos(swing) + 50.0 * random.normal()));
    last = correction.correct(ensemble)[0];
  }
  if (trusted) *trusted = {*ensemble.record(0, 0), *ensemble.record(1, 0)};
  return last;
}

TEST(Handover, FallbackThatForetellsBetterIsTrusted) {
  std::vector<StepRecord> trusted;
  const StepRecord record = after_swings(1e-4, 400.0, &trusted);
  EXPECT_GT(record.correction->handed_over, 0.95);
  EXPECT_LT((record.x - trusted[1].x).norm(), 0.05 * (trusted[0].x - trusted[1].x).norm());
}

TEST(Handover, FallbackThatForetellsWorseIsNot) {
  std::vector<StepRecord> trusted;
  const StepRecord record = after_swings(400.0, 1e-4, &trusted);
  EXPECT_LT(record.correction->handed_over, 0.05);
  EXPECT_LT((record.x - trusted[0].x).norm(), 0.05 * (trusted[0].x - trusted[1].x).norm());
}

}  // namespace
}  // namespace truebearing::handover_test
