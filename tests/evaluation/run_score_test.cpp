// SPDX-License-Identifier: Apache-2.0
#include "truebearing/evaluation/run_score.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/angle_tracks.hpp"
#include "tests/support/error_message.hpp"
#include "tests/support/line_trackers.hpp"
#include "truebearing/core/constants.hpp"
#include "truebearing/core/covariance.hpp"
#include "truebearing/evaluation/event_metrics.hpp"
#include "truebearing/evaluation/gospa_metrics.hpp"
#include "truebearing/evaluation/track_metrics.hpp"
#include "truebearing/tracker/raw_tracker.hpp"

namespace truebearing::run_score_test {
namespace {

using ::testing::ElementsAre;
using testing::error_message;
using testing::position;
using testing::RadarFilter;

StepRecord record(const BoundedVector& x, const BoundedVector& variance) {
  StepRecord made;
  made.x = x;
  made.P = variance.asDiagonal();
  return made;
}

RunScore score_of_step(const Scorer& scorer, const BoundedVector& truth, const StepRecord& made) {
  RunScore score;
  scorer.prepare(score, 1);
  StepColumns columns(scorer.dimension());
  scorer.score_step(truth, made, 0, columns, score);
  scorer.score_together(columns, score);
  return score;
}

TEST(Scorer, FindsComponentsByNameNotByPlace) {
  const StateSpace& estimate = state_space_of_components({"velocity_mps", "bias_m", "position_m"});
  const Scorer scorer(line_space(), estimate);
  EXPECT_THAT(scorer.quantities(), ElementsAre("position_m", "velocity_mps"));
  EXPECT_EQ(scorer.dimension(), 2);
  const RunScore score = score_of_step(scorer, Eigen::Vector2d(100.0, 10.0),
                                       record(Eigen::Vector3d(13.0, 999.0, 96.0), Eigen::Vector3d(9.0, 1.0, 4.0)));
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
  const RunScore score = score_of_step(scorer, Eigen::Vector4d(3.0, 4.0, 0.0, 1.0),
                                       record(Eigen::Vector4d::Zero(), Eigen::Vector4d::Ones()));
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
  ensemble.add(
      "raw", std::make_unique<RawTracker>(state_space_of_components({"position_m"}), BoundedVector::Constant(1, 2.0)));
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

// More steps than are scored at once, of which some have no truth, no measurement or are too early.
TEST(ScoreRecording, EachOfManyStepsHasItsOwnErrors) {
  Recording recording = testing::radar_family(29).simulate({});
  recording.measurements[13].z[0] = kNaN;
  recording.truth[0].x[9].setConstant(kNaN);
  Ensemble ensemble;
  ensemble.add("plain", RadarFilter{}.tracker());
  TrackerSet set(std::move(ensemble));
  set.show_member("plain");
  const Scorer scorer(line_space(), line_space());
  const RunScore score = score_recording(set, {scorer}, recording, {.from_step = 4, .loss_thresholds = {}})[0];
  const auto alone = RadarFilter{}.tracker();
  for (std::size_t step = 0; step < 29; ++step) {
    const StepRecord record = alone->step(recording.measurements[step]).front();
    const bool is_scored = step >= 3 && step != 9;
    EXPECT_EQ(!std::isnan(score.nees[step]), is_scored) << step;
    if (!is_scored) continue;
    const BoundedVector& truth = recording.truth[0].x[step];
    for (const std::size_t q : {0u, 1u}) {
      EXPECT_DOUBLE_EQ(score.error[q][step], scorer.error(q, truth, record.x)) << step;
      const auto i = static_cast<Eigen::Index>(q);
      const double d = truth[i] - record.x[i];
      EXPECT_NEAR(score.quantity_nees[q][step], d * d / record.P(i, i), 1e-12 * d * d / record.P(i, i)) << step;
    }
    const double nees = mahalanobis_squared(record.P, truth - record.x);
    EXPECT_NEAR(score.nees[step], nees, 1e-12 * nees) << step;
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

// Several at once, of unequal lengths: each as by itself.
TEST(ScoreRecordings, AreThoseOfEachAlone) {
  Ensemble ensemble;
  ensemble.add("plain", RadarFilter{}.tracker());
  ensemble.add(
      "raw", std::make_unique<RawTracker>(state_space_of_components({"position_m"}), BoundedVector::Constant(1, 2.0)));
  TrackerSet set(std::move(ensemble));
  set.show_member("plain");
  set.show_member("raw");
  const std::vector<Scorer> scorers{Scorer(line_space(), set.space(0)), Scorer(line_space(), set.space(1))};
  std::vector<Recording> recordings;
  for (const int steps : {30, 12, 1, 30, 25})
    recordings.push_back(testing::radar_family(steps).simulate({1, Role::evaluation, recordings.size()}));
  recordings[3].measurements[7].z[0] = kNaN;
  TrackerSetPack pack(set, 6);
  std::vector<const Recording*> some;
  for (const Recording& recording : recordings) some.push_back(&recording);
  std::vector<std::size_t> scored(recordings.size());
  const ScoringRule rule{.from_step = 3, .loss_thresholds = {}};
  for (int again = 0; again < 2; ++again) {
    const auto scores = score_recordings(pack, scorers, some, rule, [&](std::size_t i, std::size_t) { ++scored[i]; });
    ASSERT_EQ(scores.size(), recordings.size());
    for (std::size_t i = 0; i < recordings.size(); ++i) {
      const std::vector<RunScore> alone = score_recording(set, scorers, recordings[i], rule);
      for (std::size_t tracker = 0; tracker < 2; ++tracker)
        for (std::size_t step = 0; step < recordings[i].measurements.size(); ++step) {
          const RunScore &a = scores[i][tracker], &b = alone[tracker];
          for (const auto& [mine, theirs] :
               {std::pair(a.error[0][step], b.error[0][step]), std::pair(a.nees[step], b.nees[step]),
                std::pair(a.quantity_nees[0][step], b.quantity_nees[0][step])})
            EXPECT_TRUE(mine == theirs || (std::isnan(mine) && std::isnan(theirs)))
                << "recording " << i << " tracker " << tracker << " step " << step;
        }
    }
  }
  EXPECT_THAT(scored, ElementsAre(56u, 20u, 0u, 56u, 46u));
}

TEST(ScoreRecordings, AFewAreBestOneByOne) {
  Ensemble ensemble;
  ensemble.add("plain", RadarFilter{}.tracker());
  const bool gains = ensemble.gains_together();  // by the processor's registers
  const TrackerSet set(std::move(ensemble));
  EXPECT_EQ(set.best_together(3), 1u);
  EXPECT_EQ(set.best_together(4), gains ? 4u : 1u);
  EXPECT_EQ(set.best_together(20), gains ? 8u : 1u);
}

TEST(ScoreRecording, NeedsTheTruthOfATarget) {
  Recording recording = testing::radar_family(3).simulate({});
  recording.truth.clear();
  TrackerSet set{Ensemble{}};
  EXPECT_THAT(error_message([&] { score_recording(set, {}, recording, {}); }), ::testing::HasSubstr("0 targets"));
}

TEST(ScoreRecording, FiguresAtTimesAreOfOneTarget) {
  Recording recording = testing::radar_family(3).simulate({});
  recording.truth.push_back(recording.truth[0]);
  TrackerSet set{Ensemble{}};
  EXPECT_THAT(error_message([&] { score_recording(set, {}, recording, {.times_s = {2.0}}); }),
              ::testing::HasSubstr("scoring.times_s"));
}

// The score of a tracker that says `told` of a recording.
RunScore score_of(const testing::AnglesOfTracks& told, const Recording& recording, const ScoringRule& rule = {}) {
  Ensemble ensemble;
  ensemble.add("told", testing::told_tracker(told));
  TrackerSet set(std::move(ensemble));
  set.show_member("told");
  return score_recording(set, {Scorer(angle_space(), angle_space())}, recording, rule)[0];
}

void expect_errors(const RunScore& score, const std::vector<double>& wanted) {
  ASSERT_EQ(score.error[0].size(), wanted.size());
  for (std::size_t place = 0; place < wanted.size(); ++place) {
    EXPECT_EQ(std::isnan(score.nees[place]), std::isnan(wanted[place])) << place;
    EXPECT_EQ(std::isnan(score.quantity_nees[0][place]), std::isnan(wanted[place])) << place;
    if (std::isnan(wanted[place]))
      EXPECT_TRUE(std::isnan(score.error[0][place])) << place;
    else
      EXPECT_NEAR(score.error[0][place], wanted[place], 1e-12) << place;
  }
}

TEST(Scorer, ErrorsAreInTheUnitOfTheQuantity) {
  const RunScore score = score_of({{0, {12.0}}}, testing::angle_recording({{0, {10.0}}}));
  EXPECT_NEAR(score.error[0][0], 2.0, 1e-12) << "degrees";
  EXPECT_NEAR(score.quantity_nees[0][0], 4.0, 1e-12) << "which the NEES knows nothing of";
  const Scorer scorer(angle_space(), angle_space());
  const BoundedVector truth = Eigen::Vector2d(0.1, 0.0), estimate = Eigen::Vector2d(0.3, 0.0);
  EXPECT_DOUBLE_EQ(scorer.error(0, truth, estimate), degrees(0.2));
  EXPECT_DOUBLE_EQ(scorer.true_value(0, truth), degrees(0.1));
  EXPECT_DOUBLE_EQ(scorer.estimated_value(0, estimate), degrees(0.3));
  EXPECT_EQ(scorer.quantity("rate_degps"), 1u);
  EXPECT_FALSE(scorer.quantity("angle"));
}

TEST(ScoreRecording, TargetsOfManyStepsDoNotMix) {
  const auto angles = [](double first, double apart, int gap) {
    std::vector<double> values;
    for (int step = 0; step < 21; ++step) values.push_back(step == gap ? kNaN : first + apart * step);
    return values;
  };
  const RunScore score = score_of({{1, angles(10.0, 0.5, 9)}, {4, angles(-50.0, 1.25, -1)}},
                                  testing::angle_recording({{1, angles(10.0, 0.0, -1)}, {4, angles(-50.0, 0.0, 17)}}));
  std::vector<double> wanted;
  for (int step = 0; step < 21; ++step) wanted.push_back(step == 9 ? kNaN : 0.5 * step);
  for (int step = 0; step < 21; ++step) wanted.push_back(step == 17 ? kNaN : 1.25 * step);
  expect_errors(score, wanted);
}

TEST(ScoreRecording, TracksAreScoredAgainstTheTargetsOfTheirNumbers) {
  const Recording recording = testing::angle_recording({{1, {10, 10, 10}}, {4, {30, kNaN, 30}}});
  const RunScore score = score_of({{1, {11, 12, kNaN}}, {2, {30, 30, 30}}, {4, {35, 36, 37}}}, recording);
  EXPECT_EQ(score.targets, 2u);
  EXPECT_EQ(score.steps(), 3u);
  // No record of 1 at the last step, no target 4 at the second.
  expect_errors(score, {1, 2, kNaN, 5, kNaN, 7});
  expect_errors(score_of({{1, {11, 12, 13}}, {4, {35, 36, 37}}}, recording, {.from_step = 3}),
                {kNaN, kNaN, 3, kNaN, kNaN, 7});
}

TEST(ScoreRecording, TheOnlyTargetIsThatOfTheFirstRecordWhateverItsNumber) {
  const RunScore score = score_of({{0, {11, 12}}}, testing::angle_recording({{227006760, {10, 10}}}));
  expect_errors(score, {1, 2});
}

TEST(ScoreRecording, PhasesAndTurnsAreThoseOfTheirTargets) {
  Recording recording = testing::angle_recording({{0, {10, 10}}, {1, {30, 30}}, {2, {50, 50}}});
  recording.truth[0].phase = {0, 1};
  recording.truth[2].phase = {1, 1};
  for (Truth& truth : recording.truth) truth.turns_at_s = 1.0;
  const RunScore score = score_of({{0, {10, 10}}}, recording);
  EXPECT_THAT(score.phase, ElementsAre(0, 1, -1, -1, 1, 1));
  EXPECT_FALSE(score.of<EventFigures>()->turns_at_s) << "nobody says whose";
}

TEST(ScoreRecording, TracksOfARuleHaveAnOutcome) {
  const Recording recording = testing::angle_recording({{0, {0, 0, 0}}, {1, {20, 20, 20}}});
  const testing::AnglesOfTracks swapped{{0, {0, 20, 20}}, {1, {20, 0, 0}}};
  EXPECT_FALSE(score_of(swapped, recording).of<TrackFigures>()) << "nobody asked";
  ScoringRule rule;
  rule.families = {track_metrics({.quantity = "angle_deg", .bad = 3.0, .last_steps = 2, .excursion = 6.0})};
  EXPECT_EQ(score_of(swapped, recording, rule).of<TrackFigures>()->outcome.swapped, 2);
  EXPECT_TRUE(score_of({{0, {1, 1, 1}}, {1, {19, 19, 19}}}, recording, rule).of<TrackFigures>()->outcome.is_clean());
  rule.from_step = 3;
  EXPECT_TRUE(score_of({{0, {70, 70, 1}}, {1, {19, 19, 19}}}, recording, rule).of<TrackFigures>()->outcome.is_clean())
      << "what is not scored is not looked at";
}

TEST(ScoreRecording, GospaAssignsRecordsWhateverTheirNumbers) {
  const Recording recording = testing::angle_recording({{0, {0, 0, kNaN}}, {1, {20, 20, 20}}});
  ScoringRule rule;
  rule.assignment = AssignmentRule{"angle_deg", 4.0};
  rule.families = {gospa_metrics()};
  const RunScore score = score_of({{7, {21, 22, 23}}, {8, {1, 9, kNaN}}}, recording, rule);
  expect_errors(score, {1, kNaN, kNaN, 1, 2, 3});
  const auto* gospa = score.of<GospaFigures>();
  ASSERT_TRUE(gospa);
  EXPECT_EQ(gospa->steps, 3.0);
  EXPECT_EQ(gospa->missed, 1.0) << "the first target, at the second step";
  EXPECT_EQ(gospa->false_tracks, 1.0);
  EXPECT_NEAR(gospa->localisation, 1 + 1 + 4 + 9, 1e-9);
  EXPECT_NEAR(gospa->squared, 15 + 2 * 8, 1e-9);
  EXPECT_FALSE(score_of({{0, {0, 0, 0}}}, recording).of<GospaFigures>());
}

}  // namespace
}  // namespace truebearing::run_score_test
