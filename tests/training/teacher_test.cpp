// SPDX-License-Identifier: Apache-2.0
#include "training/teacher.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <utility>

#include "tests/support/angle_tracks.hpp"
#include "tests/support/correction_models.hpp"
#include "tests/support/error_message.hpp"
#include "tests/support/fakes.hpp"
#include "tests/support/line_trackers.hpp"
#include "tests/training/taught_radar.hpp"
#include "truebearing/core/constants.hpp"
#include "truebearing/correction/correction.hpp"

namespace truebearing::teacher_test {
namespace {

using testing::error_message;
using testing::FakeScenario;
using testing::FakeTracker;
using ::testing::HasSubstr;
using testing::RadarFilter;
using testing::taught_correction;
using testing::taught_ensemble;

// The scenario with another truth, or none, beside the same measurements.
FakeScenario other_truth(const Scenario& scenario, double offset, std::size_t from_step = 0) {
  return {scenario.truth_space(), [&scenario, offset, from_step](const RunKey& key) {
            Recording recording = scenario.simulate(key);
            for (std::size_t k = from_step; k < recording.truth[0].x.size(); ++k)
              recording.truth[0].x[k].array() += offset;
            return recording;
          }};
}

TEST(Teacher, RowsAreTruthMinusTheBaseStepByStep) {
  const LineScenario scenario = testing::radar_family(12);
  const TeacherSet set = collect_teacher_set(taught_ensemble(), taught_correction(3), scenario,
                                             {.seed = 9, .role = Role::training, .threads = 1, .progress = {}});
  ASSERT_EQ(set.X.rows(), 36);
  ASSERT_EQ(set.X.cols(), 4);
  ASSERT_EQ(set.Y.cols(), 2);
  EXPECT_EQ(set.features, testing::radar_features());
  const auto plain = RadarFilter{}.tracker();
  RadarFilter wide_filter;
  wide_filter.variance = {1e6, 5e4};
  const auto wide = wide_filter.tracker();
  Eigen::Index row = 0;
  for (std::uint64_t run = 0; run < 3; ++run) {
    const Recording recording = scenario.simulate({.seed = 9, .role = Role::training, .run = run});
    plain->reset();
    wide->reset();
    double nis_sum = 0.0;
    for (std::size_t k = 0; k < 12; ++k, ++row) {
      const StepRecord base = plain->step(recording.measurements[k])[0];
      const StepRecord companion = wide->step(recording.measurements[k])[0];
      nis_sum += base.innovation->nis;
      const double steps = static_cast<double>(k + 1);
      EXPECT_EQ(set.Y.row(row).transpose(), recording.truth[0].x[k] - base.x);
      EXPECT_EQ(set.X(row, 0), std::log(steps));
      EXPECT_EQ(set.X(row, 1), (companion.x[0] - base.x[0]) / 1000.0);
      EXPECT_EQ(set.X(row, 2), (companion.x[1] - base.x[1]) / 100.0);
      EXPECT_NEAR(set.X(row, 3), std::log(0.05 + nis_sum / steps), 1e-12);
      const Eigen::Matrix2d factor = set.covariance_factors.row(row).reshaped(2, 2);
      EXPECT_LT((factor * factor.transpose() - companion.P).norm(), 1e-12 * companion.P.norm());
    }
  }
}

TEST(Teacher, FeaturesDoNotDependOnTheTruth) {
  const LineScenario scenario = testing::radar_family(30);
  const TeacherSet set = collect_teacher_set(taught_ensemble(), taught_correction(5), scenario, {});
  const TeacherSet other = collect_teacher_set(taught_ensemble(), taught_correction(5), other_truth(scenario, 1e6), {});
  EXPECT_EQ(set.X, other.X);
  EXPECT_EQ(set.covariance_factors, other.covariance_factors);
  EXPECT_NE(set.Y, other.Y);
}

TEST(Teacher, StepsWithUnknownTruthAreLeftOut) {
  const LineScenario scenario = testing::radar_family(30);
  const TeacherSet set =
      collect_teacher_set(taught_ensemble(), taught_correction(4), other_truth(scenario, kNaN, 20), {});
  EXPECT_EQ(set.X.rows(), 4 * 20);
  EXPECT_TRUE(set.Y.allFinite());
  EXPECT_THAT(error_message([&] {
                collect_teacher_set(taught_ensemble(), taught_correction(4), other_truth(scenario, kNaN), {});
              }),
              HasSubstr("no step"));
}

TEST(Teacher, FirstStepTaughtIsAsAskedButAveragesSeeAll) {
  const LineScenario scenario = testing::radar_family(30);
  CorrectionSpec late = taught_correction(2);
  late.training.from_step = 11;
  const TeacherSet all = collect_teacher_set(taught_ensemble(), taught_correction(2), scenario, {});
  const TeacherSet tail = collect_teacher_set(taught_ensemble(), late, scenario, {});
  ASSERT_EQ(tail.X.rows(), 2 * 20);
  EXPECT_EQ(tail.X.topRows(20), all.X.middleRows(10, 20));
}

TEST(Teacher, TeachesTheFirstStepInEverySoManySeconds) {
  const LineScenario scenario = testing::radar_family(30);  // at 1, 2, ... 30 s
  CorrectionSpec sparse = taught_correction(2);
  sparse.training.every_s = 5.0;
  const TeacherSet all = collect_teacher_set(taught_ensemble(), taught_correction(2), scenario, {});
  const TeacherSet some = collect_teacher_set(taught_ensemble(), sparse, scenario, {});
  const std::vector<Eigen::Index> taught{0, 4, 9, 14, 19, 24, 29};
  ASSERT_EQ(some.X.rows(), 2 * 7);
  for (Eigen::Index run = 0; run < 2; ++run)
    for (Eigen::Index i = 0; i < 7; ++i)
      EXPECT_EQ(some.X.row(7 * run + i), all.X.row(30 * run + taught[static_cast<std::size_t>(i)]));
}

// Networks that remember see every row; what is not taught is there, and said not to be.
TEST(Teacher, WholeTracksHoldTheRowsThatAreNotTaught) {
  const LineScenario scenario = testing::radar_family(30);
  CorrectionSpec late = taught_correction(2);
  late.training.from_step = 11;
  TeacherOptions options;
  options.whole_tracks = true;
  const TeacherSet taught = collect_teacher_set(taught_ensemble(), late, scenario, {});
  const TeacherSet all = collect_teacher_set(taught_ensemble(), taught_correction(2), scenario, {});
  const TeacherSet whole = collect_teacher_set(taught_ensemble(), late, scenario, options);
  ASSERT_EQ(whole.X.rows(), 2 * 30);
  EXPECT_EQ(whole.X, all.X);
  ASSERT_EQ(whole.begins.size(), 60u);
  for (Eigen::Index row = 0; row < 60; ++row) {
    const auto i = static_cast<std::size_t>(row);
    const Eigen::Index step = row % 30;
    EXPECT_EQ(whole.begins[i], step == 0) << row;
    EXPECT_EQ(whole.is_taught(row), step >= 10) << row;
    EXPECT_TRUE(whole.used[i]) << row;
    if (step >= 10)
      EXPECT_EQ(whole.Y.row(row), taught.Y.row(20 * (row / 30) + step - 10)) << row;
    else
      EXPECT_TRUE((whole.Y.row(row).array() == 0.0).all()) << row;
  }
}

TEST(Teacher, WholeTracksOfWhichNothingIsTaughtAreRefused) {
  const LineScenario scenario = testing::radar_family(5);
  CorrectionSpec late = taught_correction(4);
  late.training.from_step = 6;
  for (const bool whole_tracks : {false, true}) {
    TeacherOptions options;
    options.whole_tracks = whole_tracks;
    EXPECT_THAT(error_message([&] { collect_teacher_set(taught_ensemble(), late, scenario, options); }),
                HasSubstr("no step"));
  }
}

TEST(Teacher, RunsWithoutTargetsTeachNothing) {
  const LineScenario scenario = testing::radar_family(5);
  const FakeScenario some(scenario.truth_space(), [&](const RunKey& key) {
    Recording recording = scenario.simulate(key);
    if (key.run % 2 == 0) recording.truth.clear();
    return recording;
  });
  for (const bool whole_tracks : {false, true}) {
    TeacherOptions options;
    options.whole_tracks = whole_tracks;
    EXPECT_EQ(collect_teacher_set(taught_ensemble(), taught_correction(4), some, options).rows(), 2 * 5);
  }
}

// A base that says `told` of targets by their angles; its NIS is the square of what it says, in degrees.
TeacherSet teach(const testing::AnglesOfTracks& told, const Recording& recording,
                 const std::vector<std::pair<std::string, double>>& leave_out_beyond = {}, bool whole_tracks = false) {
  Ensemble ensemble;
  ensemble.add("told", testing::told_tracker(told));
  CorrectionSpec correction;
  correction.design.base = correction.design.reference = correction.design.covariance_of = "told";
  correction.design.features = {{.kind = FeatureKind::log_step}, {.kind = FeatureKind::log_mean_nis, .offset = 1.0}};
  correction.training.runs = 2;
  correction.training.leave_out_beyond = leave_out_beyond;
  TeacherOptions options;
  options.whole_tracks = whole_tracks;
  return collect_teacher_set(ensemble, correction, FakeScenario(recording), options);
}

void expect_labels(const TeacherSet& set, const std::vector<double>& wanted_deg) {
  ASSERT_EQ(set.Y.rows(), 2 * std::ssize(wanted_deg)) << "two runs";
  for (Eigen::Index row = 0; row < set.Y.rows(); ++row)
    EXPECT_NEAR(degrees(set.Y(row, 0)), wanted_deg[static_cast<std::size_t>(row) % wanted_deg.size()], 1e-12) << row;
}

TEST(Teacher, EveryTrackIsTaughtTheTruthOfItsNumber) {
  const Recording recording = testing::angle_recording({{2, {10, 10, 10}}, {5, {30, kNaN, 30}}});
  const TeacherSet set = teach({{1, {9, 9, 9}}, {2, {11, 12, 13}}, {5, {kNaN, 31, 33}}}, recording);
  expect_labels(set, {-1, -2, -3, -3});
}

TEST(Teacher, FeaturesRememberEveryTrackByItself) {
  const Recording recording = testing::angle_recording({{0, {0, 0, 0}}, {1, {30, kNaN, 30}}});
  const TeacherSet set = teach({{0, {1, 2, 3}}, {1, {kNaN, 20, 40}}}, recording);
  // Steps of track 0 at rows 0, 1 and 2; track 1 has its second step at row 3, the first had no truth.
  for (const Eigen::Index row : {0, 1, 2}) EXPECT_EQ(set.X(row, 0), std::log(static_cast<double>(row + 1)));
  EXPECT_EQ(set.X(3, 0), std::log(2.0)) << "features see the steps that are not taught";
  EXPECT_NEAR(set.X(2, 1), std::log(1.0 + (1.0 + 4.0 + 9.0) / 3.0), 1e-12);
  EXPECT_NEAR(set.X(3, 1), std::log(1.0 + (400.0 + 1600.0) / 2.0), 1e-12);
}

// Where the reference has no record yet, a correction publishes none, and its features have not begun.
TEST(Teacher, FeaturesAreThoseThatACorrectionAsksItsNetworkWith) {
  const LineScenario scenario = testing::radar_family(12);
  const auto told_from = [](std::size_t first) {
    return std::make_unique<FakeTracker>(
        line_space(),
        [first](const Measurement& measurement, std::size_t step, FakeTracker::Said& said) {
          if (step < first) return;
          StepRecord record = testing::fake_record(line_space(), measurement, Eigen::Vector2d(measurement.z[0], 0.0),
                                                   1e6 * Eigen::Matrix2d::Identity());
          record.innovation =
              Innovation{measurement.z, measurement.z, BoundedMatrix::Identity(1, 1), 1.0 + static_cast<double>(step)};
          said.records.push_back(record);
        },
        RecordBlocks{.innovation = true});
  };
  Ensemble late;
  late.add("base", told_from(0));
  late.add("reference", told_from(4));
  CorrectionSpec correction;
  correction.design.base = correction.design.covariance_of = "base";
  correction.design.reference = "reference";
  correction.design.features = {{.kind = FeatureKind::log_step}, {.kind = FeatureKind::log_mean_nis, .offset = 1.0}};
  correction.training.runs = 2;
  const TeacherSet set = collect_teacher_set(late, correction, scenario, {});
  RandomStream random({}, StreamId::test);
  Correction corrects(
      std::make_shared<const CorrectionModel>(testing::line_model(
          correction.design.features, testing::random_parameters(random, 2, 3, 2), "base", "reference", "base")),
      late);
  Eigen::Index row = 0;
  for (std::uint64_t run = 0; run < 2; ++run) {
    late.reset();
    corrects.reset();
    for (const Measurement& measurement : scenario.simulate({1, Role::training, run}).measurements) {
      late.step(measurement);
      if (corrects.correct(late).empty()) continue;
      ASSERT_TRUE(corrects.accounts()[0].asked());
      ASSERT_LT(row, set.rows());
      EXPECT_EQ(set.X.row(row++).transpose(), corrects.accounts()[0].features);
    }
  }
  EXPECT_EQ(row, set.rows());
}

TEST(Teacher, WholeTracksOfSeveralTargetsComeOneBehindTheOther) {
  const Recording recording = testing::angle_recording({{0, {0, 0, 0}}, {1, {30, 30, 30}}});
  const TeacherSet set = teach({{0, {1, 2, 9}}, {1, {kNaN, 31, 32}}}, recording, {{"angle_deg", 3.0}}, true);
  const std::vector<bool> begins{true, false, false, true, false}, taught{true, true, false, true, true};
  ASSERT_EQ(set.rows(), 10) << "two runs";
  for (std::size_t i = 0; i < 10; ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    EXPECT_EQ(set.begins[i], begins[i % 5]) << i;
    EXPECT_EQ(set.taught[i], taught[i % 5]) << i;
    EXPECT_TRUE(set.used[i]) << "what is too far off to be taught is remembered: " << i;
    EXPECT_EQ(set.X(row, 0), std::log(static_cast<double>(i % 5 < 3 ? i % 5 + 1 : i % 5 - 2))) << i;
  }
  EXPECT_NEAR(degrees(set.Y(4, 0)), -2.0, 1e-12);
}

TEST(Teacher, LeavesOutStepsWithErrorsBeyondTheLimit) {
  const Recording recording = testing::angle_recording({{0, {0, 0, 0}}, {1, {30, 30, 30}}});
  const testing::AnglesOfTracks swapped{{0, {1, 30, -2}}, {1, {29, 0, 34}}};
  expect_labels(teach(swapped, recording), {-1, 1, -30, 30, 2, -4});
  const TeacherSet set = teach(swapped, recording, {{"angle_deg", 3.0}});
  expect_labels(set, {-1, 1, 2});
  EXPECT_EQ(set.X(2, 0), std::log(3.0)) << "but features see them";
  EXPECT_THAT(error_message([&] {
                teach(swapped, recording, {{"angle_rad", 3.0}});
              }),
              ::testing::AllOf(HasSubstr("leave_out_beyond"), HasSubstr("angle_deg")));
}

TEST(Teacher, TruthMayHaveMoreThanTheBase) {
  const LineScenario scenario = testing::radar_family(12);
  const TeacherSet set = collect_teacher_set(taught_ensemble(), taught_correction(3), scenario, {});
  // The truth of a line, in another order and with a bias that the base knows nothing of.
  const StateSpace& space = state_space_of_components({"velocity_mps", "bias_m", "position_m"});
  const FakeScenario with_bias(space, [&](const RunKey& key) {
    Recording recording = scenario.simulate(key);
    recording.truth_space = &space;
    for (BoundedVector& x : recording.truth[0].x) x = BoundedVector(Eigen::Vector3d(x[1], 77.0, x[0]));
    return recording;
  });
  const TeacherSet longer = collect_teacher_set(taught_ensemble(), taught_correction(3), with_bias, {});
  ASSERT_EQ(longer.Y.cols(), 2);
  EXPECT_EQ(longer.Y, set.Y);
}

TEST(Teacher, TruthOfAnotherSpaceIsRefused) {
  const FakeScenario plane(plane_space(), [](const RunKey&) { return Recording(); });
  EXPECT_THAT(error_message([&] { collect_teacher_set(taught_ensemble(), taught_correction(1), plane, {}); }),
              HasSubstr("plane"));
}

}  // namespace
}  // namespace truebearing::teacher_test
