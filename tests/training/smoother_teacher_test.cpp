// SPDX-License-Identifier: Apache-2.0
// What a smoother teaches in place of the truth.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

#include "tests/support/correction_models.hpp"
#include "tests/support/fakes.hpp"
#include "tests/support/line_trackers.hpp"
#include "tests/support/radar_study.hpp"
#include "tests/support/statistics.hpp"
#include "training/teacher.hpp"
#include "training/train_correction.hpp"
#include "truebearing/core/covariance.hpp"
#include "truebearing/tracker/smoothing_tracker.hpp"

namespace truebearing::smoother_teacher_test {
namespace {

using testing::FakeScenario;
using ::testing::HasSubstr;
using testing::RadarFilter;

constexpr int kSteps = 30;

RadarFilter wide() {
  RadarFilter radar;
  radar.variance = {1e6, 5e4};
  return radar;
}

Ensemble ensemble() {
  Ensemble made;
  made.add("plain", RadarFilter{}.tracker());
  made.add("wide", wide().tracker());
  made.add("smooth", std::make_unique<SmoothingTracker>(wide().tracker()));
  return made;
}

CorrectionSpec spec(std::size_t runs, const std::string& teacher = "smooth") {
  CorrectionSpec made;
  made.design.base = made.design.reference = "plain";
  made.design.covariance_of = "wide";
  made.design.features = testing::radar_features();
  made.training.runs = runs;
  made.training.teacher = teacher;
  return made;
}

TeacherSet whole_tracks(const CorrectionSpec& spec, const Scenario& scenario) {
  TeacherOptions options;
  options.whole_tracks = true;
  options.threads = 1;  // for several runs to be made together
  return collect_teacher_set(ensemble(), spec, scenario, options);
}

// The steps of the training runs, under the smoother.
struct Known {
  StepRecord record;
  SmoothingAccount account;
};

std::vector<Known> known_of(const Scenario& scenario, std::size_t runs) {
  SmoothingTracker smoother(wide().tracker());
  std::vector<Known> all;
  for (std::size_t run = 0; run < runs; ++run) {
    const Recording recording = scenario.simulate({.seed = 1, .role = Role::training, .run = run});
    smoother.foresee(recording.measurements);
    for (const Measurement& measurement : recording.measurements) {
      const StepRecord record = smoother.step(measurement).front();
      all.push_back({record, *smoother.account()});
    }
  }
  return all;
}

TEST(SmootherTeacher, LabelsAreTheSmoothedTrackMinusTheBaseAndNoTruth) {
  const LineScenario scenario = testing::radar_family(kSteps);
  const TeacherSet set = whole_tracks(spec(10), scenario);
  const std::vector<Known> known = known_of(scenario, 10);
  ASSERT_EQ(set.rows(), 10 * kSteps);
  const auto plain = RadarFilter{}.tracker();
  int taught = 0;
  for (Eigen::Index row = 0; row < set.rows(); ++row) {
    const auto step = static_cast<std::size_t>(row) % kSteps, run = static_cast<std::size_t>(row) / kSteps;
    if (step == 0) plain->reset();
    const Recording recording = scenario.simulate({.seed = 1, .role = Role::training, .run = run});
    const StepRecord base = plain->step(recording.measurements[step]).front();
    EXPECT_FALSE(step + 1 == kSteps && set.is_taught(row)) << "at its end it knows no more than the filter";
    if (!set.is_taught(row)) continue;
    ++taught;
    EXPECT_EQ(set.Y.row(row).transpose(), known[static_cast<std::size_t>(row)].record.x - base.x);
  }
  EXPECT_GT(taught, 5 * kSteps);
  const FakeScenario blind(scenario.truth_space(), [&](const RunKey& key) {
    Recording recording = scenario.simulate(key);
    recording.truth.clear();
    return recording;
  });
  EXPECT_EQ(whole_tracks(spec(10), blind).Y, set.Y);
}

TEST(SmootherTeacher, TeachesAsOftenAsItKnowsMore) {
  constexpr std::size_t kRuns = 100;
  const LineScenario scenario = testing::radar_family(kSteps);
  const std::vector<Known> known = known_of(scenario, kRuns);
  double expected = 0.0, variance = 0.0;
  for (const Known& step : known) {
    if (!step.account.looked_back || step.account.nis > chi_square_quantile(kSurprise, 1)) continue;
    const double weight = 1.0 - 0.5 * (step.record.P(0, 0) / step.account.filter_variance[0] +
                                       step.record.P(1, 1) / step.account.filter_variance[1]);
    expected += weight;
    variance += weight * (1.0 - weight);
  }
  const TeacherSet set = collect_teacher_set(ensemble(), spec(kRuns), scenario, {});
  EXPECT_NEAR(static_cast<double>(set.rows()), expected, 5.0 * std::sqrt(variance));
  EXPECT_LT(expected, 0.9 * static_cast<double>(known.size()));
  const TeacherSet truth = collect_teacher_set(ensemble(), spec(kRuns, ""), scenario, {});
  EXPECT_EQ(truth.rows(), static_cast<Eigen::Index>(known.size())) << "the truth teaches every step";
  EXPECT_EQ(truth.unsure.size(), 0);
}

// Its label is as unsure as it says: drawn so, the covariance is fitted to errors of the truth's size.
TEST(SmootherTeacher, LabelsAreAsUnsureAsItSays) {
  constexpr std::size_t kRuns = 100;
  const LineScenario scenario = testing::radar_family(kSteps);
  const TeacherSet set = whole_tracks(spec(kRuns), scenario);
  const std::vector<Known> known = known_of(scenario, kRuns);
  double sum = 0.0, count = 0.0;
  for (Eigen::Index row = 0; row < set.rows(); ++row) {
    if (!set.is_taught(row)) continue;
    const BoundedVector unsure = set.unsure.row(row).transpose();
    sum += mahalanobis_squared(known[static_cast<std::size_t>(row)].record.P, unsure);
    count += 2.0;
  }
  EXPECT_FALSE(testing::is_too_small(sum, count) || testing::is_too_large(sum, count)) << sum << " of " << count;
  EXPECT_LT((set.errors(set.Y) - set.unsure).norm(), 1e-12 * set.Y.norm());
}

TEST(SmootherTeacher, TeachesNothingWhereItsFilterIsSurprised) {
  const LineScenario scenario = testing::radar_family(kSteps);
  const FakeScenario jumping(scenario.truth_space(), [&](const RunKey& key) {
    Recording recording = scenario.simulate(key);
    recording.measurements[12].z[0] += 1e6;
    return recording;
  });
  const TeacherSet set = whole_tracks(spec(40), jumping);
  for (Eigen::Index row = 12; row < set.rows(); row += kSteps) EXPECT_FALSE(set.is_taught(row));
}

TEST(SmootherTeacher, TheModelSaysThatNoTruthWasSeen) {
  const testing::TemporaryFolder folder;
  const std::string study = testing::replaced(testing::kStudy, "rules = 4", "rules = 4\nteacher = \"smooth\"") +
                            "\n[trackers.smooth]\nkind = \"smoother\"\nof = \"wide\"\nshow = false\n";
  const CorrectionModel model = train_correction(Study::load(testing::write_study(folder, study)), "nfnn", {});
  EXPECT_THAT(model.provenance.at("teacher"), HasSubstr("without truth, by smooth: smoother"));
  const CorrectionModel taught = train_correction(Study::load(testing::write_study(folder)), "nfnn", {});
  EXPECT_EQ(taught.provenance.count("teacher"), 0u);
}

}  // namespace
}  // namespace truebearing::smoother_teacher_test
