// SPDX-License-Identifier: Apache-2.0
#include "truebearing/evaluation/event_metrics.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/support/fakes.hpp"
#include "tests/support/metric_runs.hpp"
#include "truebearing/evaluation/comparison.hpp"
#include "truebearing/evaluation/report.hpp"

namespace truebearing::event_metrics_test {
namespace {

using testing::find_metric;
using ::testing::HasSubstr;
using Kind = TrackEvent::Kind;

constexpr double kNever = std::numeric_limits<double>::infinity();
const Scorer kSource(plane_frequency_space(), plane_frequency_space());
const Scorer kPlane(plane_space(), plane_space());

RunScore run(std::optional<double> turns_at_s, std::vector<TrackEvent> events) {
  const auto kept = std::make_shared<EventFigures>();
  kept->turns_at_s = turns_at_s;
  kept->events = std::move(events);
  RunScore score;
  score.figures = {kept};
  return score;
}

std::vector<Metric> metrics(const Scorer& scorer, const std::vector<RunScore>& runs) {
  return testing::figures(*event_metrics(), scorer, runs);
}

TEST(EventMetrics, ByHand) {
  const std::vector<RunScore> runs{
      run(1500.0, {{Kind::source_changed, 600.0, 130.0}, {Kind::turn_began, 1540.0}, {Kind::turn_began, 1520.0}}),
      run(1200.0, {{Kind::turn_began, 1190.0}, {Kind::turn_ended, 1195.0}, {Kind::turn_began, 1300.0}}),
      run(1300.0, {{Kind::turn_ended, 1400.0}}),
      run(kNever, {{Kind::turn_began, 1400.0}}),
      run(kNever, {{Kind::source_changed, 900.0, 99.0}, {Kind::source_changed, 950.0, 100.0}}),
  };
  const std::vector<Metric> found = metrics(kSource, runs);
  EXPECT_DOUBLE_EQ(find_metric(found, "source_change_share").value, 2.0 / 5.0) << "runs, not events";
  EXPECT_DOUBLE_EQ(find_metric(found, "source_change_share").se, std::sqrt(2.5 * 3.5 / 7.0) / 6.0);
  EXPECT_EQ(find_metric(found, "turn_delay").unit, "s");
  EXPECT_DOUBLE_EQ(find_metric(found, "turn_delay").value, (20.0 + 100.0) / 2.0) << "the first one from the turn on";
  EXPECT_DOUBLE_EQ(find_metric(found, "turn_found_share").value, 2.0 / 3.0) << "of the runs that turn";
  EXPECT_DOUBLE_EQ(find_metric(found, "false_turn_share").value, 2.0 / 5.0)
      << "before the turn, and where there is none";
  for (const Metric& metric : found) EXPECT_FALSE(metric.time_s);
}

TEST(EventMetrics, AreOfTrackersThatReportAndOfWhatIsTold) {
  EXPECT_TRUE(metrics(kSource, {run(1500.0, {}), run(kNever, {})}).empty()) << "a tracker that notices nothing";
  const std::vector<Metric> untold = metrics(kPlane, {run(std::nullopt, {{Kind::turn_began, 5.0}})});
  EXPECT_TRUE(untold.empty()) << "no frequency in the truth, and no word of a turn";
  const std::vector<Metric> quiet = metrics(kPlane, {run(kNever, {{Kind::range_known, 5.0}}), run(kNever, {})});
  ASSERT_EQ(quiet.size(), 1u);
  EXPECT_EQ(quiet[0].name, "false_turn_share");
  EXPECT_EQ(quiet[0].value, 0.0);
  const std::vector<Metric> blind = metrics(kPlane, {run(1500.0, {{Kind::handed_over, 1050.0}})});
  EXPECT_EQ(find_metric(blind, "turn_found_share").value, 0.0);
  EXPECT_TRUE(std::isnan(find_metric(blind, "turn_delay").value));
}

// Stands still where the target is, and notices its turn or does not.
std::unique_ptr<Tracker> reporter(bool reports) {
  const auto say = [reports](const Measurement& measurement, std::size_t, testing::FakeTracker::Said& said) {
    said.records.push_back(
        testing::fake_record(plane_space(), measurement, BoundedVector::Zero(4), BoundedMatrix::Identity(4, 4)));
    if (reports && measurement.time_s == 30.0) said.events.push_back({Kind::turn_began, 25.0});
  };
  return std::make_unique<testing::FakeTracker>(plane_space(), say);
}

Recording turn_at_twenty() {
  Recording recording;
  recording.measured = {"east_m", "north_m"};
  recording.truth_space = &plane_space();
  recording.truth.resize(1);
  recording.truth[0].turns_at_s = 20.0;
  for (int k = 0; k < 6; ++k) {
    recording.measurements.push_back({.time_s = 10.0 * k, .z = BoundedVector::Zero(2), .sigma = {}, .sensor = {}});
    recording.truth[0].x.push_back(BoundedVector::Zero(4));
  }
  return recording;
}

TEST(EventMetrics, ComeThroughAComparison) {
  Ensemble ensemble;
  ensemble.add("awake", reporter(true));
  ensemble.add("asleep", reporter(false));
  TrackerSet set(std::move(ensemble));
  set.show_member("awake");
  set.show_member("asleep");
  ComparisonOptions options;
  options.runs = 3;
  const testing::FakeScenario scenario(turn_at_twenty());
  const Comparison comparison = compare(set, {{"turn", &scenario}}, options);
  EXPECT_EQ(find_metric(comparison.trackers[0].metrics, "turn_delay").value, 5.0);
  EXPECT_TRUE(comparison.trackers[1].metrics.empty());
  EXPECT_THAT(comparison_json(comparison), HasSubstr("\"turn_found_share\""));
  EXPECT_THAT(comparison_table(comparison), HasSubstr("turn delay s"));
}

}  // namespace
}  // namespace truebearing::event_metrics_test
