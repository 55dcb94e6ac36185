#include "truebearing/correction/feature_extractor.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/error_message.hpp"
#include "tests/support/line_trackers.hpp"

namespace truebearing {
namespace {

using testing::error_message;
using ::testing::HasSubstr;
using testing::kNaN;

const RecordBlocks kAll{.prediction = true, .innovation = true, .gain = true, .mode_probabilities = false};

FeatureExtractor extractor_of(std::vector<FeatureSpec> features, RecordBlocks blocks = kAll) {
  return {std::move(features), line_space(), [blocks](const std::string&) { return blocks; }};
}

// One step of a tracker on a line, its numbers chosen so that a formula can be checked by eye.
StepRecord step(double nu, double S, double x = 100.0, double v = 10.0) {
  StepRecord record;
  record.space = &line_space();
  record.x = Eigen::Vector2d(x, v);
  record.P = Eigen::Matrix2d::Identity();
  record.prediction = Prediction{Eigen::Vector2d(x - 7.0, v - 3.0), Eigen::Matrix2d::Identity()};
  record.innovation = Innovation{BoundedVector::Constant(1, x + 2.0), BoundedVector::Constant(1, nu),
                                 BoundedMatrix::Constant(1, 1, S), nu * nu / S};
  record.gain = Eigen::Vector2d(0.25, 0.5);
  return record;
}

StepRecord coasted() {
  StepRecord record = step(0.0, 1.0, 500.0, 500.0);
  record.status = StepStatus::coasted;
  record.prediction.reset();
  record.innovation.reset();
  record.gain.reset();
  return record;
}

double feature(FeatureExtractor& extractor, const StepRecord& base, std::vector<const StepRecord*> companions = {}) {
  FeatureExtractor::Features features;
  extractor.extract(base, companions, features);
  EXPECT_EQ(features.size(), extractor.size());
  return features[0];
}

TEST(FeatureExtractor, LogStepCountsTheMeasurementsUsed) {
  FeatureExtractor extractor = extractor_of({{.kind = FeatureKind::log_step}});
  EXPECT_EQ(feature(extractor, step(0.0, 1.0)), 0.0);
  EXPECT_EQ(feature(extractor, step(0.0, 1.0)), std::log(2.0));
  EXPECT_EQ(feature(extractor, coasted()), std::log(2.0)) << "no measurement, no step";
  EXPECT_EQ(feature(extractor, step(0.0, 1.0)), std::log(3.0));
  extractor.reset();
  EXPECT_EQ(feature(extractor, coasted()), 0.0) << "finite also before the first";
}

TEST(FeatureExtractor, GainIsThatOfItsComponent) {
  FeatureExtractor position = extractor_of({{.kind = FeatureKind::gain, .component = "position_m"}});
  FeatureExtractor velocity = extractor_of({{.kind = FeatureKind::gain, .component = "velocity_mps"}});
  EXPECT_EQ(feature(position, step(1.0, 1.0)), 0.25);
  EXPECT_EQ(feature(velocity, step(1.0, 1.0)), 0.5);
  EXPECT_EQ(feature(velocity, coasted()), 0.5) << "the last one used";
}

TEST(FeatureExtractor, ResidualIsMeasurementMinusEstimate) {
  FeatureExtractor extractor = extractor_of({{.kind = FeatureKind::residual, .component = "position_m"}});
  EXPECT_EQ(feature(extractor, step(1.0, 1.0)), 2.0);
  EXPECT_EQ(feature(extractor, coasted()), 2.0);
}

TEST(FeatureExtractor, PredictionDifferenceIsPredictionMinusEstimate) {
  FeatureExtractor position = extractor_of({{.kind = FeatureKind::prediction_difference, .component = "position_m"}});
  FeatureExtractor velocity = extractor_of({{.kind = FeatureKind::prediction_difference, .component = "velocity_mps"}});
  EXPECT_EQ(feature(position, step(1.0, 1.0)), -7.0);
  EXPECT_EQ(feature(velocity, step(1.0, 1.0)), -3.0);
}

TEST(FeatureExtractor, InnovationIsNormalised) {
  FeatureExtractor extractor = extractor_of({{.kind = FeatureKind::innovation}});
  EXPECT_EQ(feature(extractor, step(-6.0, 4.0)), -3.0);
  EXPECT_EQ(feature(extractor, coasted()), -3.0);
}

TEST(FeatureExtractor, InnovationAverageIsExponentialAndOfUnitVariance) {
  FeatureExtractor extractor = extractor_of({{.kind = FeatureKind::innovation_average, .alpha = 0.5}});
  const double deviation = std::sqrt(0.5 / 1.5);
  EXPECT_DOUBLE_EQ(feature(extractor, step(4.0, 4.0)), 1.0 / deviation);
  EXPECT_DOUBLE_EQ(feature(extractor, step(-2.0, 1.0)), -0.5 / deviation);
  EXPECT_DOUBLE_EQ(feature(extractor, coasted()), -0.5 / deviation) << "an average holds over a coasted step";
  EXPECT_DOUBLE_EQ(feature(extractor, step(1.5, 1.0)), 0.5 / deviation);
}

TEST(FeatureExtractor, LogNisAverageIsExponential) {
  FeatureExtractor extractor = extractor_of({{.kind = FeatureKind::log_nis_average, .alpha = 0.25, .offset = 0.05}});
  EXPECT_DOUBLE_EQ(feature(extractor, step(2.0, 1.0)), std::log(0.05 + 1.0));
  EXPECT_DOUBLE_EQ(feature(extractor, step(3.0, 1.0)), std::log(0.05 + 3.0));
  EXPECT_DOUBLE_EQ(feature(extractor, coasted()), std::log(0.05 + 3.0));
}

TEST(FeatureExtractor, LogMeanNisIsOverTheTrackSoFar) {
  FeatureExtractor extractor = extractor_of({{.kind = FeatureKind::log_mean_nis, .offset = 0.05}});
  EXPECT_DOUBLE_EQ(feature(extractor, coasted()), std::log(0.05));
  EXPECT_DOUBLE_EQ(feature(extractor, step(2.0, 1.0)), std::log(0.05 + 4.0));
  EXPECT_DOUBLE_EQ(feature(extractor, step(1.0, 1.0)), std::log(0.05 + 2.5));
  EXPECT_DOUBLE_EQ(feature(extractor, coasted()), std::log(0.05 + 2.5));
  EXPECT_DOUBLE_EQ(feature(extractor, step(1.0, 1.0)), std::log(0.05 + 2.0));
}

TEST(FeatureExtractor, CompanionDifferenceIsScaled) {
  FeatureExtractor extractor = extractor_of(
      {{.kind = FeatureKind::companion_difference, .component = "velocity_mps", .companion = "wide", .scale = 4.0}});
  EXPECT_EQ(extractor.companions(), std::vector<std::string>{"wide"});
  const StepRecord companion = step(0.0, 1.0, 0.0, 30.0);
  EXPECT_EQ(feature(extractor, step(0.0, 1.0), {&companion}), 5.0);
  EXPECT_EQ(feature(extractor, step(0.0, 1.0, 0.0, 34.0), {&companion}), -1.0);
}

TEST(FeatureExtractor, EstimateIsScaledAndMayBeACompanions) {
  FeatureExtractor own = extractor_of({{.kind = FeatureKind::estimate, .component = "velocity_mps", .scale = 4.0}});
  EXPECT_EQ(feature(own, step(0.0, 1.0, 0.0, 30.0)), 7.5);
  EXPECT_EQ(feature(own, coasted()), 125.0) << "the state moves on over a coasted step";
  FeatureExtractor theirs =
      extractor_of({{.kind = FeatureKind::estimate, .component = "velocity_mps", .companion = "wide", .scale = 4.0}});
  const StepRecord companion = step(0.0, 1.0, 0.0, 50.0);
  EXPECT_EQ(feature(theirs, step(0.0, 1.0, 0.0, 30.0), {&companion}), 12.5);
}

TEST(FeatureExtractor, RejectedMeasurementDoesNotCount) {
  FeatureExtractor extractor = extractor_of({{.kind = FeatureKind::log_mean_nis, .offset = 0.05}});
  const double before = feature(extractor, step(2.0, 1.0));
  StepRecord gated = step(1000.0, 1.0);
  gated.status = StepStatus::rejected;
  EXPECT_EQ(feature(extractor, gated), before);
}

TEST(FeatureExtractor, CompanionsOwnInnovationsCanBeTheFeature) {
  FeatureExtractor extractor = extractor_of({{.kind = FeatureKind::innovation, .companion = "wide"}});
  const StepRecord companion = step(8.0, 4.0);
  EXPECT_EQ(feature(extractor, step(1.0, 1.0), {&companion}), 4.0);
}

TEST(FeatureExtractor, CompanionWithoutARecordGivesNaN) {
  for (const FeatureSpec& spec :
       {FeatureSpec{.kind = FeatureKind::companion_difference, .component = "velocity_mps", .companion = "wide"},
        FeatureSpec{.kind = FeatureKind::estimate, .component = "velocity_mps", .companion = "wide"},
        FeatureSpec{.kind = FeatureKind::innovation, .companion = "wide"},
        FeatureSpec{.kind = FeatureKind::innovation_average, .companion = "wide", .alpha = 0.5},
        FeatureSpec{.kind = FeatureKind::log_mean_nis, .companion = "wide", .offset = 0.1}}) {
    FeatureExtractor extractor = extractor_of({spec});
    const StepRecord companion = step(8.0, 4.0);
    EXPECT_TRUE(std::isnan(feature(extractor, step(1.0, 1.0), {nullptr}))) << describe(spec);
    EXPECT_TRUE(std::isfinite(feature(extractor, step(1.0, 1.0), {&companion}))) << describe(spec);
    EXPECT_TRUE(std::isnan(feature(extractor, step(1.0, 1.0), {nullptr}))) << describe(spec);
  }
}

TEST(FeatureExtractor, CompanionOfAnotherSizeGivesNaN) {
  FeatureExtractor extractor =
      extractor_of({{.kind = FeatureKind::companion_difference, .component = "velocity_mps", .companion = "wide"}});
  StepRecord companion = step(8.0, 4.0);
  companion.x = BoundedVector::Zero(1);
  EXPECT_TRUE(std::isnan(feature(extractor, step(1.0, 1.0), {&companion})));
}

TEST(FeatureExtractor, NewTrackBeginsAfresh) {
  const std::vector<FeatureSpec> specs{{.kind = FeatureKind::log_step},
                                       {.kind = FeatureKind::innovation_average, .alpha = 0.5},
                                       {.kind = FeatureKind::log_nis_average, .alpha = 0.5, .offset = 0.05},
                                       {.kind = FeatureKind::log_mean_nis, .offset = 0.05}};
  FeatureExtractor used = extractor_of(specs), fresh = extractor_of(specs);
  FeatureExtractor::Features a, b;
  for (int k = 0; k < 5; ++k) used.extract(step(9.0, 1.0), {}, a);
  StepRecord next = step(1.0, 1.0);
  next.track = 1;
  used.extract(next, {}, a);
  fresh.extract(next, {}, b);
  EXPECT_EQ(a, b);
}

TEST(FeatureExtractor, CompanionIsListedOnceHoweverManyFeaturesNameIt) {
  FeatureExtractor extractor =
      extractor_of({{.kind = FeatureKind::companion_difference, .component = "position_m", .companion = "wide"},
                    {.kind = FeatureKind::companion_difference, .component = "position_m", .companion = "narrow"},
                    {.kind = FeatureKind::companion_difference, .component = "velocity_mps", .companion = "wide"}});
  EXPECT_EQ(extractor.companions(), (std::vector<std::string>{"wide", "narrow"}));
  FeatureExtractor::Features features;
  const StepRecord wide = step(0.0, 1.0, 101.0, 12.0), narrow = step(0.0, 1.0, 104.0, 10.0);
  const std::vector<const StepRecord*> companions{&wide, &narrow};
  extractor.extract(step(0.0, 1.0), companions, features);
  EXPECT_EQ(Eigen::Vector3d(features), Eigen::Vector3d(1.0, 4.0, 2.0));
}

std::string refusal(const FeatureSpec& spec, RecordBlocks blocks = kAll) {
  return error_message([&] { extractor_of({spec}, blocks); });
}

TEST(FeatureExtractor, UnknownComponentIsRefusedWithTheNearest) {
  EXPECT_THAT(refusal({.kind = FeatureKind::gain, .component = "velocity_ms"}),
              HasSubstr("did you mean \"velocity_mps\""));
}

TEST(FeatureExtractor, ConstantsOutOfRangeAreRefused) {
  for (const double bad : {0.0, -1.0, kNaN, testing::kInfinity}) {
    EXPECT_THAT(refusal({.kind = FeatureKind::innovation_average, .alpha = bad}), HasSubstr("alpha"));
    EXPECT_THAT(refusal({.kind = FeatureKind::log_mean_nis, .offset = bad}), HasSubstr("offset"));
    EXPECT_THAT(
        refusal(
            {.kind = FeatureKind::companion_difference, .component = "position_m", .companion = "wide", .scale = bad}),
        HasSubstr("scale"));
  }
  EXPECT_THAT(refusal({.kind = FeatureKind::innovation_average, .alpha = 1.01}), HasSubstr("alpha"));
  EXPECT_EQ(refusal({.kind = FeatureKind::innovation_average, .alpha = 1.0}), "no error");
}

TEST(FeatureExtractor, DifferenceNeedsACompanion) {
  EXPECT_THAT(refusal({.kind = FeatureKind::companion_difference, .component = "position_m"}), HasSubstr("companion"));
}

TEST(FeatureExtractor, CompanionThatDoesNotRunIsRefused) {
  const auto build = [] {
    FeatureExtractor({{.kind = FeatureKind::innovation, .companion = "wide"}}, line_space(),
                     [](const std::string& name) {
                       if (name == "wide") throw InputError("trackers", "there is no \"wide\"");
                       return kAll;
                     });
  };
  EXPECT_THAT(error_message(build), HasSubstr("wide"));
}

TEST(FeatureExtractor, BlocksThatTheRecordsLackAreRefused) {
  EXPECT_THAT(refusal({.kind = FeatureKind::gain, .component = "position_m"}, {.prediction = true, .innovation = true}),
              HasSubstr("gain"));
  EXPECT_THAT(refusal({.kind = FeatureKind::prediction_difference, .component = "position_m"}, {}),
              HasSubstr("prediction"));
  for (const FeatureKind kind : {FeatureKind::residual, FeatureKind::innovation, FeatureKind::innovation_average,
                                 FeatureKind::log_nis_average, FeatureKind::log_mean_nis})
    EXPECT_THAT(refusal({.kind = kind, .component = "position_m", .alpha = 0.5, .offset = 0.5}, {}),
                HasSubstr("innovation"));
  EXPECT_EQ(refusal({.kind = FeatureKind::log_step}, {}), "no error");
}

TEST(FeatureExtractor, NumberOfFeaturesIsBounded) {
  EXPECT_THAT(error_message([] { extractor_of({}); }), HasSubstr("1 to 16"));
  EXPECT_THAT(error_message([] { extractor_of(std::vector<FeatureSpec>(17, {.kind = FeatureKind::log_step})); }),
              HasSubstr("1 to 16"));
}

TEST(Feature, NamesGoThereAndBackAndMisspeltOnesAreSuggested) {
  EXPECT_EQ(feature_kind_names().size(), 10u);
  for (const std::string& name : feature_kind_names()) EXPECT_EQ(to_string(feature_kind(name)), name);
  EXPECT_THAT(error_message([] { feature_kind("inovation"); }), HasSubstr("did you mean \"innovation\""));
}

// What mirror training relies on: under a mirrored target every feature keeps or changes its sign as its parity says.
TEST(Feature, ParityIsWhatAMirroredTargetDoes) {
  std::vector<FeatureSpec> specs;
  for (const std::string& name : feature_kind_names())
    specs.push_back({.kind = feature_kind(name),
                     .component = "position_m",
                     .companion = name == "companion_difference" ? "wide" : "",
                     .alpha = 0.3,
                     .offset = 0.1});
  FeatureExtractor extractor = extractor_of(specs), mirrored = extractor_of(specs);
  RandomStream random({}, StreamId::test);
  testing::RadarFilter radar;
  const auto tracker = radar.tracker(), mirror_tracker = radar.tracker();
  radar.variance = {1e6, 5e4};
  const auto wide = radar.tracker(), mirror_wide = radar.tracker();
  FeatureExtractor::Features a, b;
  for (int k = 1; k <= 30; ++k) {
    const double z = 200.0 * k + 3000.0 * random.normal();
    const std::vector<const StepRecord*> companion{&wide->step(testing::position(k, z))[0]};
    const std::vector<const StepRecord*> mirror_companion{&mirror_wide->step(testing::position(k, -z))[0]};
    extractor.extract(tracker->step(testing::position(k, z))[0], companion, a);
    mirrored.extract(mirror_tracker->step(testing::position(k, -z))[0], mirror_companion, b);
    for (Eigen::Index i = 0; i < a.size(); ++i)
      ASSERT_EQ(b[i], mirror_parity(specs[static_cast<std::size_t>(i)].kind) * a[i])
          << describe(specs[static_cast<std::size_t>(i)]);
  }
}

}  // namespace
}  // namespace truebearing
