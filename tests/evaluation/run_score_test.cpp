#include "truebearing/evaluation/run_score.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/error_message.hpp"
#include "tests/support/line_trackers.hpp"
#include "truebearing/tracker/raw_tracker.hpp"

namespace truebearing {
namespace {

using testing::error_message;
using ::testing::ElementsAre;
using testing::kNaN;
using testing::position;
using testing::RadarFilter;

StepRecord record(const BoundedVector& x, const BoundedVector& variance) {
  StepRecord made;
  made.x = x;
  made.P = variance.asDiagonal();
  return made;
}

TEST(Scorer, FindsComponentsByNameNotByPlace) {
  const StateSpace& estimate = state_space_of_components({"velocity_mps", "bias_m", "position_m"});
  const Scorer scorer(line_space(), estimate);
  EXPECT_THAT(scorer.quantities(), ElementsAre("position_m", "velocity_mps"));
  EXPECT_EQ(scorer.dimension(), 2);
  RunScore score;
  scorer.prepare(score, 1);
  scorer.score_step(Eigen::Vector2d(100.0, 10.0), record(Eigen::Vector3d(13.0, 999.0, 96.0), Eigen::Vector3d(9.0, 1.0, 4.0)), 0, score);
  EXPECT_EQ(score.error[0][0], 4.0);
  EXPECT_EQ(score.error[1][0], 3.0);
  EXPECT_DOUBLE_EQ(score.nees[0], 16.0 / 4.0 + 9.0 / 9.0);
}

TEST(Scorer, OfATrackerWithoutVelocityHasPositionsOnly) {
  const Scorer scorer(line_space(), state_space_of_components({"position_m"}));
  EXPECT_THAT(scorer.quantities(), ElementsAre("position_m"));
  EXPECT_EQ(scorer.dimension(), 1);
}

TEST(Scorer, ErrorOfAVectorIsItsNorm) {
  const Scorer scorer(plane_space(), plane_space());
  RunScore score;
  scorer.prepare(score, 1);
  scorer.score_step(Eigen::Vector4d(3.0, 4.0, 0.0, 1.0), record(Eigen::Vector4d::Zero(), Eigen::Vector4d::Ones()), 0, score);
  EXPECT_DOUBLE_EQ(score.error[0][0], 5.0);
  EXPECT_DOUBLE_EQ(score.error[1][0], 1.0);
  EXPECT_DOUBLE_EQ(score.nees[0], 26.0);
}

TEST(Scorer, WithoutACommonQuantityThereIsNothingToScore) {
  EXPECT_THAT(error_message([] { Scorer(line_space(), state_space_of_components({"bearing_rad"})); }),
              ::testing::HasSubstr("no quantity in common"));
  // Half of a vector is no quantity.
  EXPECT_THAT(error_message([] { Scorer(plane_space(), state_space_of_components({"east_m"})); }),
              ::testing::HasSubstr("no quantity in common"));
}

TEST(ScoreRecording, StepsWithoutRecordTruthOrBeforeTheFirstAreNotScored) {
  Recording recording;
  recording.truth_space = &line_space();
  recording.truth.resize(1);
  for (int k = 1; k <= 6; ++k) {
    recording.measurements.push_back(position(k, k == 4 ? kNaN : 10.0 * k + 1.0));
    recording.truth[0].x.emplace_back(Eigen::Vector2d(k == 5 ? kNaN : 10.0 * k, 10.0));
  }
  Ensemble ensemble;
  ensemble.add("raw", std::make_unique<RawTracker>(state_space_of_components({"position_m"}), BoundedVector::Constant(1, 2.0)));
  TrackerSet set(std::move(ensemble));
  set.show_member("raw");
  const std::vector<Scorer> scorers{Scorer(line_space(), set.space(0))};
  const RunScore score = score_recording(set, scorers, recording, {.from_step = 2, .loss_thresholds = {}})[0];
  const std::vector<bool> scored{false, true, true, false, false, true};
  for (std::size_t step = 0; step < 6; ++step) {
    EXPECT_EQ(!std::isnan(score.error[0][step]), scored[step]) << step;
    EXPECT_EQ(!std::isnan(score.nees[step]), scored[step]) << step;
    if (!scored[step]) continue;
    EXPECT_DOUBLE_EQ(score.error[0][step], 1.0);
    EXPECT_DOUBLE_EQ(score.nees[step], 0.25);
  }
}

TEST(ScoreRecording, SetIsResetFirst) {
  const Recording recording = testing::radar_family(30).simulate({});
  Ensemble ensemble;
  ensemble.add("plain", RadarFilter{}.tracker());
  TrackerSet set(std::move(ensemble));
  set.show_member("plain");
  const std::vector<Scorer> scorers{Scorer(line_space(), line_space())};
  const RunScore first = score_recording(set, scorers, recording, {})[0];
  const RunScore second = score_recording(set, scorers, recording, {})[0];
  EXPECT_EQ(first.error, second.error);
  EXPECT_EQ(first.nees, second.nees);
}

TEST(ScoreRecording, NeedsTheTruthOfOneTarget) {
  Recording recording = testing::radar_family(3).simulate({});
  recording.truth.push_back(recording.truth[0]);
  TrackerSet set{Ensemble{}};
  EXPECT_THAT(error_message([&] { score_recording(set, {}, recording, {}); }), ::testing::HasSubstr("2 targets"));
}

}  // namespace
}  // namespace truebearing
