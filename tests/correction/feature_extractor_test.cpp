// SPDX-License-Identifier: Apache-2.0
#include "truebearing/correction/feature_extractor.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/error_message.hpp"
#include "tests/support/line_trackers.hpp"
#include "truebearing/core/constants.hpp"
#include "truebearing/filter/kalman.hpp"
#include "truebearing/motion/constant_velocity.hpp"
#include "truebearing/tracker/filter_tracker_of.hpp"
#include "truebearing/tracker/polar_sensor.hpp"
#include "truebearing/tracker/position_sensor.hpp"

namespace truebearing::feature_extractor_test {
namespace {

using testing::error_message;
using ::testing::HasSubstr;

const RecordBlocks kAll{.prediction = true, .innovation = true, .gain = true, .mode_probabilities = false};

FeatureExtractor extractor_of(std::vector<FeatureSpec> features, RecordBlocks blocks = kAll) {
  return {std::move(features), line_space(), Frame::state, [blocks](const std::string&) { return blocks; }};
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

TEST(FeatureExtractor, LogIntervalIsSinceTheLastMeasurementUsed) {
  FeatureExtractor extractor = extractor_of({{.kind = FeatureKind::log_interval}});
  const auto at = [&](StepRecord record, double time_s) {
    record.time_s = time_s;
    return feature(extractor, record);
  };
  EXPECT_EQ(at(step(0.0, 1.0), 10.0), std::log(1e-3)) << "the track begins";
  EXPECT_EQ(at(step(0.0, 1.0), 12.0), std::log(2.0));
  EXPECT_EQ(at(coasted(), 15.0), std::log(3.0));
  EXPECT_EQ(at(coasted(), 17.0), std::log(5.0)) << "nothing was used in between";
  EXPECT_EQ(at(step(0.0, 1.0), 20.0), std::log(8.0));
  EXPECT_EQ(at(step(0.0, 1.0), 21.0), std::log(1.0));
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

StepRecord beside(double difference_m, double closeness) {
  StepRecord record = step(1.0, 1.0);
  record.P(0, 0) = 25.0;
  record.neighbour = Neighbour{1, Eigen::Vector2d(difference_m, -2.0), closeness, false};
  return record;
}

TEST(FeatureExtractor, NeighbourCountsAsFarAsItIsClose) {
  const RecordBlocks blocks{.neighbour = true};
  FeatureSpec spec{.kind = FeatureKind::neighbour_difference, .component = "position_m", .scale = 4.0};
  FeatureExtractor closeness = extractor_of({{.kind = FeatureKind::neighbour_closeness}}, blocks),
                   position = extractor_of({spec}, blocks);
  EXPECT_EQ(feature(closeness, beside(30.0, 0.5)), 0.5);
  EXPECT_EQ(feature(position, beside(30.0, 0.5)), 0.5 * 30.0 / 4.0);
  EXPECT_EQ(feature(closeness, step(1.0, 1.0)), 0.0) << "of no neighbour, also after one";
  EXPECT_EQ(feature(position, step(1.0, 1.0)), 0.0);
  spec.scale_is_sigma = true;
  FeatureExtractor sigmas = extractor_of({spec}, blocks);
  EXPECT_EQ(feature(sigmas, beside(30.0, 0.5)), 0.5 * 30.0 / 5.0);
  spec = {.kind = FeatureKind::neighbour_difference, .component = "velocity_mps", .scale = 4.0};
  FeatureExtractor velocity = extractor_of({spec}, blocks);
  EXPECT_EQ(feature(velocity, beside(30.0, 1.0)), -0.5);
}

TEST(FeatureExtractor, NeighbourIsNeededInTheRecords) {
  EXPECT_THAT(error_message([] { extractor_of({{.kind = FeatureKind::neighbour_closeness}}); }),
              HasSubstr("needs the neighbour in the records of the base tracker"));
  EXPECT_THAT(error_message([] {
                extractor_of({{.kind = FeatureKind::neighbour_difference, .component = "height_m", .scale = 1.0}},
                             {.neighbour = true});
              }),
              HasSubstr("height_m"));
}

TEST(FeatureExtractor, NeighboursDifferenceIsThatOfAMirroredPair) {
  const FeatureSpec difference{.kind = FeatureKind::neighbour_difference, .component = "position_m"};
  EXPECT_EQ(mirror_parity(difference, Frame::state, line_space()), -1);
  EXPECT_EQ(mirror_parity({.kind = FeatureKind::neighbour_closeness}, Frame::state, line_space()), +1);
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
  for (const double bad : {0.0, -1.0, kNaN, kInfinity}) {
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
    FeatureExtractor({{.kind = FeatureKind::innovation, .companion = "wide"}}, line_space(), Frame::state,
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

TEST(FeatureExtractor, SensorIsWhoTookTheMeasurement) {
  FeatureExtractor extractor = extractor_of({{.kind = FeatureKind::sensor, .sensor = 2}});
  testing::RadarFilter radar;
  const auto tracker = radar.tracker();
  FeatureExtractor::Features features;
  StepRecord record =
      tracker->step({.time_s = 1.0, .z = BoundedVector::Constant(1, 5.0), .sigma = {}, .sensor = {}})[0];
  extractor.extract(record, {}, features);
  EXPECT_EQ(features[0], 0.0);
  record.source = 1;
  extractor.extract(record, {}, features);
  EXPECT_EQ(features[0], 1.0);
  EXPECT_THAT(error_message([] { extractor_of({{.kind = FeatureKind::sensor}}); }), HasSubstr("from 1"));
}

TEST(FeatureExtractor, NumberOfFeaturesIsBounded) {
  EXPECT_THAT(error_message([] { extractor_of({}); }), HasSubstr("1 to 16"));
  EXPECT_THAT(error_message([] { extractor_of(std::vector<FeatureSpec>(17, {.kind = FeatureKind::log_step})); }),
              HasSubstr("1 to 16"));
}

TEST(Feature, NamesGoThereAndBackAndMisspeltOnesAreSuggested) {
  EXPECT_EQ(feature_kind_names().size(), 27u);
  for (const std::string& name : feature_kind_names()) EXPECT_EQ(to_string(feature_kind(name)), name);
  EXPECT_THAT(error_message([] { feature_kind("inovation"); }), HasSubstr("did you mean \"innovation\""));
}

// What mirror training relies on: under a mirrored target every feature keeps or changes its sign as its parity says.
TEST(Feature, ParityIsWhatAMirroredTargetDoes) {
  std::vector<FeatureSpec> specs;
  for (const std::string& name : feature_kind_names()) {
    const FeatureNeeds needs = needs_of(feature_kind(name));
    if (needs.plane || needs.mode) continue;  // below
    specs.push_back({.kind = feature_kind(name),
                     .component = "position_m",
                     .companion = name == "companion_difference" ? "wide" : "",
                     .alpha = 0.3,
                     .offset = 0.1,
                     .sensor = 1});
  }
  RecordBlocks blocks = kAll;
  blocks.neighbour = true;
  FeatureExtractor extractor = extractor_of(specs, blocks), mirrored = extractor_of(specs, blocks);
  // The companion stands for the nearest other target too.
  const auto with_neighbour = [](StepRecord record, const StepRecord& other) {
    record.neighbour = Neighbour{1, other.x - record.x, 0.25, false};
    return record;
  };
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
    extractor.extract(with_neighbour(tracker->step(testing::position(k, z))[0], *companion[0]), companion, a);
    mirrored.extract(with_neighbour(mirror_tracker->step(testing::position(k, -z))[0], *mirror_companion[0]),
                     mirror_companion, b);
    for (Eigen::Index i = 0; i < a.size(); ++i)
      ASSERT_EQ(b[i], mirror_parity(specs[static_cast<std::size_t>(i)], Frame::state, line_space()) * a[i])
          << describe(specs[static_cast<std::size_t>(i)]);
  }
}

// A base and a companion in the plane, stepped on one stream of positions; `mirror` flips the East component, which
// mirrors the target about the North axis, and `turn` turns it, sensor and all.
class PlaneTrackers {
 public:
  using Motion = ConstantVelocity<2, DiscreteWhiteNoise>;

  explicit PlaneTrackers(std::vector<FeatureSpec> specs,
                         std::unique_ptr<AnySensor> sensor = sensor_of(PositionSensor<2>{{100.0, 100.0}, 1.0}))
      : base_(plane_space(), state_of<KalmanFilter<4>>(Motion{{8.0}}), sensor->fresh(), TwoPointStart{}),
        companion_(plane_space(), state_of<KalmanFilter<4>>(Motion{{20.0}}), sensor->fresh(), TwoPointStart{}),
        extractor_(std::move(specs), plane_space(), Frame::track, [&](const std::string&) { return base_.blocks(); }) {}

  bool step(double time_s, const Eigen::Vector2d& z, FeatureExtractor::Features& features) {
    const Measurement measurement{.time_s = time_s, .z = z, .sigma = {}, .sensor = {}};
    const auto base = base_.step(measurement), companion = companion_.step(measurement);
    if (base.empty()) return false;
    const std::vector<const StepRecord*> companions{&companion[0]};
    extractor_.extract(base[0], companions, features);
    return true;
  }

 private:
  FilterTracker base_, companion_;
  FeatureExtractor extractor_;
};

// Courses in degrees; a turn to starboard is positive. A record that
// uses no measurement is held against the last that did, and leaves no trace.
TEST(FeatureExtractor, FrameTurnIsTheAngleSinceTheLastMeasurementUsed) {
  FeatureExtractor extractor({{.kind = FeatureKind::frame_turn}}, plane_space(), Frame::track,
                             [](const std::string&) { return kAll; });
  const auto turned = [&](double course_deg, StepStatus status = StepStatus::ok) {
    StepRecord record;
    record.space = &plane_space();
    const double course = course_deg * kPi / 180.0;
    record.x = Eigen::Vector4d(0.0, 0.0, 50.0 * std::sin(course), 50.0 * std::cos(course));
    record.P = Eigen::Matrix4d::Identity();
    record.status = status;
    if (status == StepStatus::ok)
      record.innovation =
          Innovation{BoundedVector::Zero(2), BoundedVector::Zero(2), BoundedMatrix::Identity(2, 2), 0.0};
    return feature(extractor, record) * 180.0 / kPi;
  };
  EXPECT_EQ(turned(90.0), 0.0);
  EXPECT_NEAR(turned(60.0), -30.0, 1e-9);
  EXPECT_NEAR(turned(100.0, StepStatus::coasted), 40.0, 1e-9);
  EXPECT_NEAR(turned(60.0), 0.0, 1e-9);
  EXPECT_NEAR(turned(75.0), 15.0, 1e-9);
}

std::vector<FeatureSpec> plane_features() {
  std::vector<FeatureSpec> specs{{.kind = FeatureKind::log_step},
                                 {.kind = FeatureKind::log_nis_average, .alpha = 0.2, .offset = 0.05},
                                 {.kind = FeatureKind::log_speed},
                                 {.kind = FeatureKind::aspect_cosine},
                                 {.kind = FeatureKind::aspect_sine}};
  for (const char* component : {"along_m", "cross_m"}) {
    specs.push_back({.kind = FeatureKind::innovation, .component = component});
    specs.push_back({.kind = FeatureKind::innovation_average, .component = component, .alpha = 0.3});
    specs.push_back({.kind = FeatureKind::gain, .component = component});
    specs.push_back({.kind = FeatureKind::residual, .component = component});
  }
  for (const char* component : {"along_mps", "cross_mps"})
    specs.push_back({.kind = FeatureKind::companion_difference,
                     .component = component,
                     .companion = "lively",
                     .scale_is_sigma = true});
  return specs;
}

std::vector<Eigen::Vector2d> turning_target() {
  std::vector<Eigen::Vector2d> z;
  RandomStream random({.seed = 8}, StreamId::test);
  Eigen::Vector2d position(3000.0, 9000.0);
  for (int k = 0; k < 60; ++k) {
    const double course = 0.4 + (k > 20 ? 0.05 * (k - 20) : 0.0);
    position += 200.0 * Eigen::Vector2d(std::sin(course), std::cos(course));
    z.push_back(position + 100.0 * Eigen::Vector2d(random.normal(), random.normal()));
  }
  return z;
}

TEST(TrackFrame, FeaturesOfAMirroredTargetFollowTheirParity) {
  const std::vector<FeatureSpec> specs = plane_features();
  PlaneTrackers trackers(specs), mirrored(specs);
  FeatureExtractor::Features a, b;
  double time_s = 0.0;
  for (const Eigen::Vector2d& z : turning_target()) {
    time_s += 1.0;
    if (!trackers.step(time_s, z, a) | !mirrored.step(time_s, Eigen::Vector2d(-z.x(), z.y()), b)) continue;
    for (Eigen::Index i = 0; i < a.size(); ++i) {
      const FeatureSpec& spec = specs[static_cast<std::size_t>(i)];
      EXPECT_NEAR(b[i], mirror_parity(spec, Frame::track, plane_space()) * a[i], 1e-9 * (1.0 + std::abs(a[i])))
          << describe(spec);
    }
  }
}

TEST(TrackFrame, FeaturesDoNotDependOnTheCourse) {
  const std::vector<FeatureSpec> specs = plane_features();
  PlaneTrackers trackers(specs), turned(specs);
  const Eigen::Matrix2d R = (Eigen::Matrix2d() << 0.6, 0.8, -0.8, 0.6).finished();
  FeatureExtractor::Features a, b;
  double time_s = 0.0;
  for (const Eigen::Vector2d& z : turning_target()) {
    time_s += 1.0;
    if (!trackers.step(time_s, z, a) | !turned.step(time_s, R * z, b)) continue;
    for (Eigen::Index i = 0; i < a.size(); ++i)
      EXPECT_NEAR(b[i], a[i], 1e-9 * (1.0 + std::abs(a[i]))) << describe(specs[static_cast<std::size_t>(i)]);
  }
}

TEST(TrackFrame, FeaturesDoNotDependOnTheCourseWhereErrorsAreCorrelated) {
  constexpr double kTurn_rad = 0.8;
  const std::vector<FeatureSpec> specs = plane_features();
  const auto radar = sensor_of(ConvertedSensor{{.sigma = {50.0, 0.05}}});
  PlaneTrackers trackers(specs, radar->fresh()), turned(specs, radar->fresh());
  FeatureExtractor::Features a, b;
  double time_s = 0.0;
  int compared = 0;
  for (const Eigen::Vector2d& z : turning_target()) {
    time_s += 1.0;
    const Eigen::Vector2d polar(z.norm(), std::atan2(z.x(), z.y()));
    if (!trackers.step(time_s, polar, a) | !turned.step(time_s, polar + Eigen::Vector2d(0.0, kTurn_rad), b)) continue;
    ++compared;
    for (std::size_t i = 0; i < specs.size(); ++i) {
      const auto k = static_cast<Eigen::Index>(i);
      EXPECT_NEAR(b[k], a[k], 1e-9 * (1.0 + std::abs(a[k]))) << describe(specs[i]);
    }
  }
  EXPECT_GT(compared, 50);
}

TEST(TrackFrame, RotationIsItsOwnInverseAndPutsTheVelocityAlong) {
  const BoundedVector x = Eigen::Vector4d(10.0, -20.0, 30.0, -40.0);
  const FrameRotation rotation(Frame::track, x);
  const BoundedVector turned = rotation.vector(x);
  EXPECT_NEAR(turned[2], 50.0, 1e-12);
  EXPECT_NEAR(turned[3], 0.0, 1e-12);
  EXPECT_LT((rotation.vector(turned) - x).norm(), 1e-12);
  // Cross is to starboard: a target that heads North has East there.
  EXPECT_EQ(FrameRotation(Frame::track, Eigen::Vector4d(0.0, 0.0, 0.0, 5.0)).vector(Eigen::Vector2d(1.0, 0.0))[1], 1.0);
  Eigen::Matrix4d A = Eigen::Matrix4d::Random();
  const BoundedMatrix P = A * A.transpose();
  const BoundedMatrix Q = rotation.covariance(P);
  EXPECT_NEAR(Q.trace(), P.trace(), 1e-12);
  EXPECT_LT((rotation.covariance(Q) - P).norm(), 1e-12);
  EXPECT_NEAR(turned.dot(Q * turned), x.dot(P * x), 1e-6);
}

TEST(TrackFrame, NeedsThePlaneAndMeasuredPositions) {
  EXPECT_THAT(error_message([] {
                FeatureExtractor({{.kind = FeatureKind::log_step}}, line_space(), Frame::track,
                                 [](const std::string&) { return kAll; });
              }),
              HasSubstr("plane"));
  EXPECT_THAT(error_message([] {
                FeatureExtractor({{.kind = FeatureKind::innovation, .component = "cross_m"}}, plane_space(),
                                 Frame::track, [](const std::string&) { return kAll; });
              }),
              HasSubstr("not a position"));
  EXPECT_THAT(error_message([] {
                FeatureExtractor({{.kind = FeatureKind::innovation, .component = "cross_mps"}}, plane_space(),
                                 Frame::track, [](const std::string&) { return kAll; });
              }),
              HasSubstr("not measured"));
}

}  // namespace
}  // namespace truebearing::feature_extractor_test
