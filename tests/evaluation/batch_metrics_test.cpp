// SPDX-License-Identifier: Apache-2.0
#include "truebearing/evaluation/batch_metrics.hpp"

#include <gtest/gtest.h>

#include "tests/support/line_trackers.hpp"
#include "tests/support/metric_runs.hpp"

#include "truebearing/core/constants.hpp"

namespace truebearing::batch_metrics_test {
namespace {

using testing::figures;
using testing::find_metric;
using testing::pointers;

const Scorer kScorer(line_space(), line_space());

// A run with one time.
RunScore at_a_time(std::optional<BatchOutcome> outcome) {
  const auto kept = std::make_shared<BatchFigures>();
  kept->at_times = {outcome};
  RunScore score;
  score.figures = {kept};
  return score;
}

const RunScore kUnsolved = at_a_time(std::nullopt);

RunScore solved(double cost, int iterations = 0, int non_finite = 0) {
  return at_a_time(BatchOutcome{cost, iterations, 225, non_finite});
}

TEST(BatchMetrics, AreOverRunsAndTimesAtWhichTheySolved) {
  const std::vector<RunScore> runs{solved(1.0, 10, 81), solved(1.0, 4, 0), kUnsolved};
  const std::vector<Metric> metrics = figures(*batch_metrics(), kScorer, runs);
  EXPECT_DOUBLE_EQ(find_metric(metrics, "non_finite_starts").value, 40.5);
  EXPECT_DOUBLE_EQ(find_metric(metrics, "iterations").value, 7.0);
}

TEST(GlobalMinimumShare, CountsCostsThatAreNoHigherThanTheReferences) {
  const std::vector<RunScore> reference{solved(50.0), solved(50.0), solved(50.0), solved(50.0), kUnsolved};
  const std::vector<RunScore> scores{solved(50.00004), solved(50.01), solved(49.0), solved(kNaN), solved(1.0)};
  const std::vector<Metric> share = global_minimum_share(pointers(scores), pointers(reference));
  ASSERT_EQ(share.size(), 1u);
  EXPECT_EQ(share[0].name, "global_minimum_share");
  EXPECT_DOUBLE_EQ(share[0].value, 0.5) << "of the four at which the reference solved";
  const std::vector<RunScore> filter(5, kUnsolved);
  EXPECT_TRUE(global_minimum_share(pointers(filter), pointers(reference)).empty()) << "it has no minimum";
}

}  // namespace
}  // namespace truebearing::batch_metrics_test
