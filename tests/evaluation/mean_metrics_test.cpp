// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/error_message.hpp"
#include "tests/support/metric_runs.hpp"
#include "truebearing/core/constants.hpp"
#include "truebearing/evaluation/metric_registry.hpp"

namespace truebearing::mean_metrics_test {
namespace {

using testing::error_message;
using testing::find_metric;
using ::testing::HasSubstr;

ScoringRule read(const std::string& text) {
  const SharedTable table = parse_toml(text, "study.toml");
  TableReader reader(table, "study.toml", "scoring");
  ScoringRule rule;
  read_metrics(reader, line_space(), rule);
  reader.finish();
  return rule;
}

RunScore run(std::vector<double> position, std::vector<double> velocity) {
  RunScore score;
  score.error = {std::move(position), std::move(velocity)};
  return score;
}

TEST(MeanMetrics, ByHand) {
  const std::vector<RunScore> runs{run({3.0, 9.0, kNaN}, {1.0, 1.0, kNaN}), run({0.0, 0.0, 3.0}, {2.0, 2.0, 2.0})};
  const ScoringRule rule = read("mean_error = true");
  const Scorer scorer(line_space(), line_space());
  ASSERT_EQ(rule.families.size(), usual_metrics().size() + 1);
  const std::vector<Metric> found = testing::figures(*rule.families.back(), scorer, runs, rule);
  ASSERT_EQ(found.size(), 4u);
  EXPECT_NEAR(find_metric(found, "position_mean_error").value, 3.0, 1e-12) << "15 m in five steps";
  // Without either run the mean is 1 or 6.
  EXPECT_NEAR(find_metric(found, "position_mean_error").se, 2.5, 1e-12);
  EXPECT_EQ(find_metric(found, "position_mean_error").unit, "m");
  EXPECT_NEAR(find_metric(found, "position_mse").value, 99.0 / 5.0, 1e-12);
  EXPECT_EQ(find_metric(found, "position_mse").unit, "m^2");
  EXPECT_NEAR(find_metric(found, "velocity_mean_error").value, 8.0 / 5.0, 1e-12);
  EXPECT_EQ(find_metric(found, "velocity_mse").unit, "(m/s)^2");
}

TEST(MeanMetrics, AreNoneWhereNobodyAsks) {
  EXPECT_EQ(read("mean_error = false").families.size(), usual_metrics().size());
  EXPECT_THAT(error_message([] { read("mean_eror = true"); }), HasSubstr("did you mean \"mean_error\""));
}

}  // namespace
}  // namespace truebearing::mean_metrics_test
