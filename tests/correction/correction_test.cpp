// SPDX-License-Identifier: Apache-2.0
#include "truebearing/correction/correction.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>

#include "tests/support/correction_models.hpp"
#include "tests/support/error_message.hpp"
#include "tests/support/fakes.hpp"
#include "tests/support/line_trackers.hpp"
#include "truebearing/core/constants.hpp"
#include "truebearing/core/covariance.hpp"
#include "truebearing/correction/corrected_tracker.hpp"

namespace truebearing::correction_test {
namespace {

using testing::box;
using testing::error_message;
using ::testing::HasSubstr;
using testing::line_model;
using testing::position;
using testing::radar_features;
using testing::radar_log;
using testing::RadarFilter;
using testing::random_parameters;
using testing::ScriptedTracker;
using testing::shared;

struct Scene {
  Ensemble ensemble;
  ScriptedTracker* base;
  ScriptedTracker* reference;
  ScriptedTracker* source;
};

Scene scene() {
  Scene made;
  const auto add = [&](const char* name) {
    auto tracker = std::make_unique<ScriptedTracker>();
    ScriptedTracker* raw = tracker.get();
    made.ensemble.add(name, std::move(tracker));
    return raw;
  };
  made.base = add("base");
  made.reference = add("reference");
  made.source = add("source");
  return made;
}

// One rule, so that the network says `y` whatever its input.
FuzzyNetwork::Parameters constant(Eigen::Index inputs, const Eigen::Vector2d& y) {
  return {.input_mean = Eigen::VectorXd::Zero(inputs),
          .input_scale = Eigen::VectorXd::Ones(inputs),
          .input_clip = 4.0,
          .centres = Eigen::MatrixXd::Zero(1, inputs),
          .widths = Eigen::MatrixXd::Ones(1, inputs),
          .consequents = y.transpose(),
          .output_scale = Eigen::VectorXd::Ones(2)};
}

const std::vector<FeatureSpec> kResidual{{.kind = FeatureKind::residual, .component = "position_m"}};

Ensemble radar_ensemble() {
  Ensemble ensemble;
  RadarFilter plain, tuned, wide;
  tuned.variance = {1e6, 7e4};
  tuned.sigma_m = 4000.0;
  wide.variance = {1e6, 160000.0 / 3.0};
  ensemble.add("plain", plain.tracker());
  ensemble.add("tuned", tuned.tracker());
  ensemble.add("wide", wide.tracker());
  return ensemble;
}

CorrectionModel radar_model(std::uint64_t run) {
  RandomStream random({.seed = 5, .role = Role::training, .run = run}, StreamId::test);
  FuzzyNetwork::Parameters parameters = random_parameters(random, 4, 16, 2);
  parameters.input_mean = Eigen::Vector4d(4.0, 0.0, 0.0, 0.0);
  parameters.output_scale = Eigen::Vector2d(2000.0, 100.0);
  CorrectionModel model = line_model(radar_features(), parameters, "plain", "tuned", "wide");
  model.rules().inflation = Eigen::VectorXd::NullaryExpr(16, [&] { return random.uniform(0.5, 2.0); });
  model.gate = box(4, -3.0, 6.0);
  return model;
}

TEST(Correction, IsTheReferencePlusTheLimitedDifference) {
  Scene s = scene();
  s.base->record.x = Eigen::Vector2d(100.0, 10.0);
  s.reference->record.x = Eigen::Vector2d(103.0, 9.0);
  s.reference->record.P = BoundedVector(Eigen::Vector2d(4.0, 1.0)).asDiagonal();
  s.source->record.P = BoundedVector(Eigen::Vector2d(2.0, 0.5)).asDiagonal();
  CorrectionModel model = line_model(kResidual, constant(1, {5.0, -2.0}), "base", "reference", "source");
  model.rules().inflation[0] = 1.5;
  Correction free(shared(model), s.ensemble, {.kappa = kInfinity});
  Correction limited(shared(model), s.ensemble, {.kappa = 1.0});
  s.ensemble.step(position(1.0, 0.0));

  const StepRecord open = free.correct(s.ensemble)[0];
  EXPECT_LT((open.x - Eigen::Vector2d(105.0, 8.0)).norm(), 1e-12);
  EXPECT_LT((open.P - 1.5 * s.source->record.P).norm(), 1e-12);
  EXPECT_EQ(open.correction->gate, 1.0);
  EXPECT_FALSE(open.correction->limited);
  EXPECT_NEAR(open.correction->distance_sigmas, std::sqrt(2.0), 1e-12);
  EXPECT_EQ(open.correction->base_x, s.base->record.x);
  EXPECT_EQ(open.correction->base_P, s.base->record.P);

  const StepRecord held = limited.correct(s.ensemble)[0];
  EXPECT_LT((held.x - Eigen::Vector2d(103.0 + 2.0 / std::sqrt(2.0), 9.0 - 1.0 / std::sqrt(2.0))).norm(), 1e-12);
  EXPECT_TRUE(held.correction->limited);
}

TEST(Correction, HandOverCovarianceIsThatOfTheMixture) {
  for (const double outside : {0.02, 0.1, 0.3, 1.0}) {
    Scene s = scene();
    s.base->record.x = Eigen::Vector2d(100.0, 10.0);
    s.base->record.innovation->z[0] = 101.0 + outside;  // residual 1 + outside, in a box that ends at 1 and is 2 wide
    s.reference->record.x = Eigen::Vector2d(103.0, 9.0);
    s.reference->record.P << 4.0, 0.5, 0.5, 1.0;
    s.source->record.P << 2.0, -0.3, -0.3, 0.5;
    CorrectionModel model = line_model(kResidual, constant(1, {5.0, -2.0}), "base", "reference", "source");
    model.rules().inflation[0] = 1.5;
    model.gate = box(1, -1.0, 1.0);
    Correction correction(shared(model), s.ensemble);
    s.ensemble.step(position(1.0, 0.0));
    const StepRecord record = correction.correct(s.ensemble)[0];

    const double edges = (s.base->record.innovation->z[0] - 100.0 - 1.0) / 0.2;
    const double g = std::exp(-0.5 * edges * edges);
    const Eigen::Vector2d d(2.0, -1.0);
    const Eigen::Matrix2d P =
        g * 1.5 * s.source->record.P + (1.0 - g) * s.reference->record.P + g * (1.0 - g) * d * d.transpose();
    EXPECT_NEAR(record.correction->gate, g, 1e-12);
    EXPECT_LT((record.x - s.reference->record.x - g * d).norm(), 1e-12);
    EXPECT_LT((record.P - P).norm(), 1e-12);
    EXPECT_TRUE(is_covariance(record.P));
  }
}

// Of a residual a fifth of an edge outside a box that ends at 1 and is 2 wide, and a wish of five standard deviations.
TEST(Correction, AccountSaysWhatWasAskedAndWhoHeldItBack) {
  Scene s = scene();
  s.base->record.innovation->z[0] = 1.04;
  CorrectionModel model = line_model(kResidual, constant(1, {5.0, 0.0}), "base", "reference", "source");
  model.gate = box(1, -1.0, 1.0, 100.0);
  Correction correction(shared(model), s.ensemble);
  EXPECT_TRUE(correction.accounts().empty());
  s.ensemble.step(position(1.0, 0.0));
  const StepRecord record = correction.correct(s.ensemble)[0];
  ASSERT_EQ(correction.accounts().size(), 1u);
  const CorrectionAccount& account = correction.accounts()[0];
  ASSERT_TRUE(account.asked());
  EXPECT_NEAR(account.features[0], 1.04, 1e-12);
  EXPECT_NEAR(account.box, std::exp(-0.5 * 0.2 * 0.2), 1e-12);
  EXPECT_EQ(account.box, record.correction->gate);
  EXPECT_EQ(account.referee.position, 1.0);
  EXPECT_NEAR(account.disagreement, 5.0 / std::sqrt(2.0), 1e-12);
  EXPECT_NEAR(account.wanted_sigmas, 5.0, 1e-12);
  EXPECT_NEAR(record.correction->distance_sigmas, 3.0 * account.box, 1e-12) << "what kappa left of it";

  s.base->record.innovation->z[0] = kNaN;
  s.ensemble.step(position(2.0, 0.0));
  correction.correct(s.ensemble);
  EXPECT_FALSE(correction.accounts()[0].asked()) << "what has no value is not asked about";
}

// What bounds a correction is said beside the model, and may change without it.
TEST(Correction, GateThatIsNotUsedLeavesTheBoxAside) {
  Scene s = scene();
  s.base->record.innovation->z[0] = 20.0;
  CorrectionModel model = line_model(kResidual, constant(1, {1.0, -2.0}), "base", "reference", "source");
  model.gate = box(1, -1.0, 1.0);
  Correction gated(shared(model), s.ensemble), free(shared(model), s.ensemble, {.gate = false});
  s.ensemble.step(position(1.0, 0.0));
  EXPECT_EQ(gated.correct(s.ensemble)[0].correction->gate, 0.0);
  EXPECT_EQ(free.correct(s.ensemble)[0].correction->gate, 1.0);
  EXPECT_EQ(free.correct(s.ensemble)[0].x, Eigen::Vector2d(1.0, -2.0));
}

TEST(Correction, IsWithinThreeStandardDeviationsWhereNothingElseIsSaid) {
  Scene s = scene();
  Correction correction(shared(line_model(kResidual, constant(1, {50.0, 0.0}), "base", "reference", "source")),
                        s.ensemble);
  s.ensemble.step(position(1.0, 0.0));
  const StepRecord record = correction.correct(s.ensemble)[0];
  EXPECT_TRUE(record.correction->limited);
  EXPECT_NEAR(record.x[0], 3.0, 1e-12);
}

TEST(Correction, OutsideTheBoxTheReferenceStands) {
  Scene s = scene();
  s.reference->record.x = Eigen::Vector2d(103.0, 9.0);
  s.reference->record.P << 4.0, 0.5, 0.5, 1.0;
  CorrectionModel model = line_model(kResidual, constant(1, {5.0, -2.0}), "base", "reference", "source");
  model.gate = box(1, -1.0, 1.0);
  Correction correction(shared(model), s.ensemble);
  for (const double z : {20.0, -1e6, 1e308, kNaN, kInfinity}) {
    s.base->record.innovation->z[0] = z;
    s.ensemble.step(position(1.0, 0.0));
    const StepRecord record = correction.correct(s.ensemble)[0];
    EXPECT_EQ(record.x, s.reference->record.x) << z;
    EXPECT_EQ(record.P, s.reference->record.P) << z;
    EXPECT_EQ(record.correction->gate, 0.0) << z;
    EXPECT_EQ(record.correction->distance_sigmas, 0.0) << z;
  }
}

// The other side of the box: how far apart network and reference are for what both claim, here sqrt(5) in the position.
TEST(Correction, NetworkThatContradictsTheReferenceMoreThanItEverDidHandsOver) {
  Scene s = scene();
  s.reference->record.P = BoundedVector(Eigen::Vector2d(4.0, 1.0)).asDiagonal();
  for (const double disagreement : {1.0, 2.0, 2.1, 2.5, 30.0, 1e200, 5e307}) {
    CorrectionModel model =
        line_model(kResidual, constant(1, {std::sqrt(5.0) * disagreement, 0.0}), "base", "reference", "source");
    model.gate = box(1, -1.0, 1.0, 2.0);
    Correction correction(shared(model), s.ensemble);
    s.ensemble.step(position(1.0, 0.0));
    const StepRecord record = correction.correct(s.ensemble)[0];
    const double edges = std::max(disagreement - 2.0 - 1e-12, 0.0) / 0.1;
    const double g = std::exp(-0.5 * edges * edges);
    EXPECT_NEAR(record.correction->gate, g, 1e-9) << disagreement;
    EXPECT_NEAR(record.x[0], g * std::min(std::sqrt(5.0) * disagreement, 6.0), 1e-8) << disagreement;
  }
}

TEST(Correction, WithoutBaseOrCovarianceSourceTheReferenceStands) {
  Scene s = scene();
  s.reference->record.x = Eigen::Vector2d(103.0, 9.0);
  Correction correction(shared(line_model(kResidual, constant(1, {5.0, -2.0}), "base", "reference", "source")),
                        s.ensemble, {.kappa = kInfinity});
  const auto corrected = [&] {
    s.ensemble.step(position(1.0, 0.0));
    return correction.correct(s.ensemble);
  };
  EXPECT_EQ(corrected()[0].x, Eigen::Vector2d(5.0, -2.0));
  s.base->record.status = StepStatus::failed;
  EXPECT_EQ(corrected()[0].x, s.reference->record.x);
  EXPECT_EQ(corrected()[0].correction->gate, 0.0);
  s.base->record.status = StepStatus::ok;
  s.source->shown = false;
  EXPECT_EQ(corrected()[0].x, s.reference->record.x);
  s.source->shown = true;
  s.base->record.track = 4;
  EXPECT_EQ(corrected()[0].x, s.reference->record.x) << "records of different tracks are not compared";
  s.reference->shown = false;
  EXPECT_TRUE(corrected().empty());
}

// The promise of the house: never more than kappa standard deviations of the reference from it, whatever the weights
// and inputs.
TEST(Correction, PublishedEstimateIsFiniteAndWithinKappaOfTheReference) {
  RandomStream random({.seed = 17}, StreamId::test);
  const std::array<double, 14> hostile{kNaN,  kInfinity, -kInfinity, 1.7e308, -1e308,  1e300,  1e154,
                                       1e-10, 1e-308,    5e-324,     0.0,     -1e-200, -1e300, -1.0};
  const auto any = [&] { return hostile[random.index(hostile.size())]; };
  const auto finite = [&] { return hostile[3 + random.index(hostile.size() - 3)]; };
  const auto positive = [&] { return std::max(std::abs(finite()), 1e-300); };
  const std::vector<FeatureSpec> features{
      {.kind = FeatureKind::log_step},
      {.kind = FeatureKind::residual, .component = "position_m"},
      {.kind = FeatureKind::innovation_average, .alpha = 0.3},
      {.kind = FeatureKind::log_mean_nis, .offset = 0.05},
      {.kind = FeatureKind::companion_difference, .component = "velocity_mps", .companion = "source", .scale = 1e-3}};
  int moved = 0, limited = 0;
  for (int model_number = 0; model_number < 1000; ++model_number) {
    Scene s = scene();
    FuzzyNetwork::Parameters parameters =
        random_parameters(random, 5, 1 + static_cast<Eigen::Index>(random.index(8)), 2);
    const bool wild = model_number % 3 != 0;
    const auto spoil = [&](auto& values, const auto& make) {
      for (Eigen::Index i = 0; i < values.size(); ++i)
        if (random.uniform() < 0.3) values.data()[i] = make();
    };
    if (wild) {
      spoil(parameters.consequents, finite);
      spoil(parameters.output_scale, positive);
      spoil(parameters.centres, finite);
      spoil(parameters.widths, positive);
      spoil(parameters.input_mean, finite);
      spoil(parameters.input_scale, positive);
    } else {
      parameters.consequents *= std::pow(10.0, random.uniform(-2.0, model_number % 15 == 0 ? 300.0 : 6.0));
    }
    CorrectionModel model;
    try {
      model = line_model(features, parameters, "base", "reference", "source");
    } catch (const InputError&) {
      continue;  // refused when the file is read: all the better
    }
    if (wild) spoil(model.rules().inflation, positive);
    const bool bounded = model_number % 10 != 9;
    const double kappa = bounded ? std::pow(10.0, random.uniform(-2.0, 3.0)) : kInfinity;
    if (random.uniform() < 0.5)
      model.gate = box(5, -random.uniform(0.1, 5.0), random.uniform(0.1, 5.0), model_number % 2 == 0 ? kInfinity : 3.0);
    Correction correction(shared(model), s.ensemble, {.kappa = kappa});
    for (int step = 0; step < 110; ++step) {
      for (ScriptedTracker* tracker : {s.base, s.reference, s.source}) {
        const double scale = std::pow(10.0, random.uniform(-3.0, 5.0));
        const Eigen::Matrix2d A = Eigen::Matrix2d::NullaryExpr([&] { return random.normal(); });
        tracker->record.P = scale * scale * (A * A.transpose() + 0.05 * Eigen::Matrix2d::Identity());
        tracker->record.x = scale * 100.0 * Eigen::Vector2d::NullaryExpr([&] { return random.normal(); });
      }
      Innovation& innovation = *s.base->record.innovation;
      innovation.nu[0] = random.uniform() < 0.03 ? any() : random.normal();
      innovation.z[0] = random.uniform() < 0.3 ? any() : random.normal();
      innovation.S(0, 0) = random.uniform() < 0.03 ? any() : 1.0;
      innovation.nis = random.uniform() < 0.03 ? any() : innovation.nu[0] * innovation.nu[0];
      if (random.uniform() < 0.2) s.base->record.x[static_cast<Eigen::Index>(random.index(2))] = any();
      if (random.uniform() < 0.1) s.source->record.P(0, 0) = any();
      if (random.uniform() < 0.1) s.source->record.x[1] = any();
      s.base->record.track = s.reference->record.track = s.source->record.track = step / 10;
      s.ensemble.step(position(step, 0.0));
      const auto records = correction.correct(s.ensemble);
      ASSERT_EQ(records.size(), 1u);
      const StepRecord& record = records[0];
      const StepRecord& reference = s.reference->record;
      ASSERT_TRUE(record.x.allFinite()) << model_number << " " << step;
      ASSERT_TRUE(is_covariance(record.P)) << model_number << " " << step << "\n" << record.P;
      ASSERT_GE(record.correction->gate, 0.0);
      ASSERT_LE(record.correction->gate, 1.0);
      if (bounded) {
        const double distance = std::sqrt(mahalanobis_squared(reference.P, BoundedVector(record.x - reference.x)));
        // To 1e-9, and to what rounding to the digits of the reference's own x adds.
        const double rounding = 1e-15 * reference.x.norm() / std::sqrt(reference.P.diagonal().minCoeff() * 1e-3);
        ASSERT_LE(distance, kappa * (1.0 + 1e-9) + rounding) << model_number << " " << step;
        ASSERT_LE(record.correction->distance_sigmas, kappa * (1.0 + 1e-9));
      }
      moved += record.x != reference.x ? 1 : 0;
      limited += record.correction->limited ? 1 : 0;
    }
  }
  EXPECT_GT(moved, 10000) << "the bound must not be kept by correcting nothing";
  EXPECT_GT(limited, 10000);
}

TEST(Correction, ZeroNetworkOnTheBaseIsThePlainTrackerToTheBit) {
  FuzzyNetwork::Parameters parameters = constant(2, {0.0, 0.0});
  std::vector<FeatureSpec> features = kResidual;
  features.push_back({.kind = FeatureKind::log_step});
  CorrectionModel model = line_model(features, parameters);
  model.gate = box(2, -2000.0, 3.0);
  Ensemble ensemble;
  RadarFilter radar;
  radar.options = {.gate_nis = 6.0, .lost_after_s = 5.0};
  ensemble.add("plain", radar.tracker());
  CorrectedTracker corrected(std::move(ensemble), shared(model));
  const auto plain = radar.tracker();
  int partly = 0;
  for (Measurement measurement : radar_log(2, 240)) {
    const int k = static_cast<int>(measurement.time_s);
    if (k % 11 == 0 || (k > 100 && k < 110)) measurement.z[0] = kNaN;
    for (int again = 0; again < (k % 13 == 0 ? 2 : 1); ++again) {
      const auto expected = plain->step(measurement);
      const auto records = corrected.step(measurement);
      ASSERT_EQ(records.size(), expected.size());
      if (records.empty()) continue;
      EXPECT_EQ(records[0].x, expected[0].x);
      EXPECT_EQ(records[0].P, expected[0].P);
      EXPECT_EQ(records[0].status, expected[0].status);
      EXPECT_EQ(records[0].track, expected[0].track);
      EXPECT_EQ(records[0].time_s, expected[0].time_s);
      const double g = records[0].correction->gate;
      partly += g > 0.0 && g < 1.0 ? 1 : 0;
    }
  }
  EXPECT_GT(partly, 20) << "also where the gate is half open";
}

TEST(Correction, OrderOfTheRulesChangesNothing) {
  const CorrectionModel model = radar_model(1);
  CorrectionModel turned = model;
  FuzzyNetwork::Parameters parameters = model.rules().network.parameters();
  for (Eigen::MatrixXd* rows : {&parameters.centres, &parameters.widths, &parameters.consequents})
    *rows = rows->colwise().reverse().eval();
  turned.rules().network = FuzzyNetwork(parameters);
  turned.rules().inflation = model.rules().inflation.reverse().eval();
  CorrectedTracker a(radar_ensemble(), shared(model)), b(radar_ensemble(), shared(turned));
  for (const Measurement& measurement : radar_log(1, 240)) {
    const StepRecord first = a.step(measurement)[0], second = b.step(measurement)[0];
    ASSERT_LT((first.x - second.x).norm(), 1e-12 * (1.0 + first.x.norm()));
    ASSERT_LT((first.P - second.P).norm(), 1e-12 * first.P.norm());
  }
}

TEST(Correction, NoticesWhatItsBaseDoes) {
  Scene s = scene();
  s.base->noticed = {{TrackEvent::Kind::turn_began, 5.0}};
  s.reference->noticed = {{TrackEvent::Kind::range_known, 4.0}, {TrackEvent::Kind::handed_over, 6.0}};
  const CorrectedTracker tracker(
      std::move(s.ensemble), shared(line_model(kResidual, constant(1, {5.0, -2.0}), "base", "reference", "source")));
  ASSERT_EQ(tracker.events().size(), 1u);
  EXPECT_EQ(tracker.events()[0].kind, TrackEvent::Kind::turn_began);
}

TEST(Correction, MissingMeasurementLeavesNoTrace) {
  CorrectedTracker tracker(radar_ensemble(), shared(radar_model(3)));
  const auto clean = tracker.fresh();
  for (const Measurement& measurement : radar_log(3, 150)) {
    const int k = static_cast<int>(measurement.time_s);
    if (k % 4 == 2) {
      EXPECT_EQ(tracker.step(position(measurement.time_s - 0.5, kNaN))[0].status, StepStatus::coasted);
    }
    const StepRecord with = tracker.step(measurement)[0], without = clean->step(measurement)[0];
    ASSERT_EQ(with.x, without.x) << k;
    ASSERT_EQ(with.P, without.P) << k;
    if (k % 7 == 3) tracker.step(measurement);  // a repetition: once, counted
  }
  EXPECT_EQ(tracker.counts().missing, 38);
  EXPECT_EQ(tracker.counts().repeated, 22);
}

TEST(Correction, BaseInTheRecordStaysWhatItWas) {
  CorrectedTracker tracker(radar_ensemble(), shared(radar_model(4)));
  const auto plain = RadarFilter{}.tracker();
  for (const Measurement& measurement : radar_log(4, 100)) {
    const StepRecord expected = plain->step(measurement)[0];
    const StepRecord record = tracker.step(measurement)[0];
    ASSERT_EQ(record.correction->base_x, expected.x) << "open loop: nothing is written back";
    ASSERT_EQ(record.correction->base_P, expected.P);
  }
}

// What the base predicted, innovated and gained is not the correction's: a NIS of it would say nothing of what is
// published.
TEST(Correction, RecordTellsNothingThatIsNotItsOwn) {
  CorrectedTracker tracker(radar_ensemble(), shared(radar_model(4)));
  const RecordBlocks blocks = tracker.blocks();
  EXPECT_FALSE(blocks.prediction || blocks.innovation || blocks.gain || blocks.measures_position);
  for (const Measurement& measurement : radar_log(4, 20)) {
    const StepRecord record = tracker.step(measurement)[0];
    ASSERT_FALSE(record.prediction || record.innovation || record.gain || record.mode_probabilities);
    ASSERT_TRUE(record.correction.has_value());
  }
  Scene s = scene();
  s.base->shown = false;
  CorrectedTracker bare(std::move(s.ensemble),
                        shared(line_model(kResidual, constant(1, {5.0, -2.0}), "base", "reference", "source")));
  const StepRecord record = bare.step(position(1.0, 0.0))[0];
  EXPECT_FALSE(record.innovation) << "nor of the reference, where that stands";
  EXPECT_EQ(record.correction->base_x.size(), 0) << "and there was no base";
}

TEST(Correction, ResetAndFreshBeginAnew) {
  CorrectedTracker tracker(radar_ensemble(), shared(radar_model(4)));
  for (const Measurement& measurement : radar_log(4, 100)) tracker.step(measurement);
  const auto copy = tracker.fresh();
  tracker.reset();
  CorrectedTracker fresh(radar_ensemble(), shared(radar_model(4)));
  for (const Measurement& measurement : radar_log(5, 50)) {
    const StepRecord expected = fresh.step(measurement)[0];
    ASSERT_EQ(tracker.step(measurement)[0].x, expected.x);
    ASSERT_EQ(copy->step(measurement)[0].x, expected.x);
  }
}

TEST(Correction, MemberThatIsNotThereIsNamed) {
  Ensemble ensemble;
  ensemble.add("plain", RadarFilter{}.tracker());
  EXPECT_THAT(error_message([&] { Correction(shared(radar_model(1)), ensemble); }), HasSubstr("tuned"));
  ensemble.add("tuned", RadarFilter{}.tracker());
  EXPECT_THAT(error_message([&] { Correction(shared(radar_model(1)), ensemble); }), HasSubstr("wide"));
  ensemble.add("wide", RadarFilter{}.tracker());
  EXPECT_EQ(error_message([&] { Correction(shared(radar_model(1)), ensemble); }), "no error");
}

TEST(Correction, BlockThatTheRecordsLackIsRefusedWhenItIsBuilt) {
  Ensemble ensemble;
  ensemble.add("plain", std::make_unique<ScriptedTracker>(RecordBlocks{}));
  CorrectionModel model = line_model(kResidual, constant(1, {0.0, 0.0}));
  EXPECT_THAT(error_message([&] { Correction(shared(model), ensemble); }), HasSubstr("innovation"));
  model.design.features = {{.kind = FeatureKind::gain, .component = "position_m"}};
  EXPECT_THAT(error_message([&] { Correction(shared(model), ensemble); }), HasSubstr("gain"));
  model.design.features = {{.kind = FeatureKind::prediction_difference, .component = "position_m"}};
  EXPECT_THAT(error_message([&] { Correction(shared(model), ensemble); }), HasSubstr("prediction"));
}

TEST(Correction, ModelWhosePartsDisagreeIsRefused) {
  Ensemble ensemble;
  ensemble.add("plain", RadarFilter{}.tracker());
  const CorrectionModel good = line_model(kResidual, constant(1, {0.0, 0.0}));
  EXPECT_EQ(error_message([&] { Correction(shared(good), ensemble); }), "no error");
  CorrectionModel bad = good;
  bad.design.features.push_back({.kind = FeatureKind::log_step});
  EXPECT_THAT(error_message([&] { Correction(shared(bad), ensemble); }), HasSubstr("features"));
  bad = good;
  bad.rules().inflation[0] = 0.0;
  EXPECT_THAT(error_message([&] { Correction(shared(bad), ensemble); }), HasSubstr("inflation"));
  EXPECT_THAT(error_message([&] { Correction(shared(good), ensemble, {.kappa = 0.0}); }), HasSubstr("kappa"));
  bad = good;
  bad.gate = box(2, -1.0, 1.0);
  EXPECT_THAT(error_message([&] { Correction(shared(bad), ensemble); }), HasSubstr("gate"));
  bad = good;
  bad.gate = box(1, 1.0, -1.0);
  EXPECT_THAT(error_message([&] { Correction(shared(bad), ensemble); }), HasSubstr("gate"));
}

}  // namespace
}  // namespace truebearing::correction_test
