// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/error_message.hpp"
#include "tests/support/metric_runs.hpp"
#include "truebearing/core/constants.hpp"
#include "truebearing/evaluation/metric_registry.hpp"

namespace truebearing::mse_metrics_test {
namespace {

using testing::error_message;
using testing::find_metric;
using ::testing::HasSubstr;

ScoringRule read(const std::string& text, const StateSpace& truth = line_space()) {
  const SharedTable table = parse_toml(text, "study.toml");
  TableReader reader(table, "study.toml", "scoring");
  ScoringRule rule;
  read_metrics(reader, truth, rule);
  reader.finish();
  return rule;
}

RunScore run(std::vector<double> position, std::vector<double> velocity) {
  RunScore score;
  score.error = {std::move(position), std::move(velocity)};
  return score;
}

TEST(MseMetrics, ByHand) {
  const std::vector<RunScore> runs{run({3.0, 1.0}, {1.0, 1.0}), run({2.0, kNaN}, {0.0, kNaN})};
  const ScoringRule rule = read("mse_db = true");
  ASSERT_EQ(rule.families.size(), usual_metrics().size() + 1);
  const Scorer scorer(line_space(), line_space());
  const Metric found = find_metric(testing::figures(*rule.families.back(), scorer, runs, rule), "mse_db");
  EXPECT_NEAR(found.value, 10.0 * std::log10(16.0 / 6.0), 1e-12) << "12 of four components, and 4 of two";
  // Without either run the mean is 2 or 3, so that the jackknife says 0.5 m^2.
  EXPECT_NEAR(found.se, 10.0 / std::log(10.0) * 0.5 / (16.0 / 6.0), 1e-12);
  EXPECT_EQ(found.unit, "dB");
}

TEST(MseMetrics, APositionInThePlaneIsTwoComponents) {
  const std::vector<RunScore> runs{run({2.0}, {4.0})};
  const ScoringRule rule = read("mse_db = true", plane_space());
  const Scorer scorer(plane_space(), plane_space());
  EXPECT_NEAR(find_metric(testing::figures(*rule.families.back(), scorer, runs, rule), "mse_db").value,
              10.0 * std::log10(20.0 / 4.0), 1e-12);
}

TEST(MseMetrics, AreNoneWhereNobodyAsks) {
  EXPECT_EQ(read("mse_db = false").families.size(), usual_metrics().size());
  EXPECT_THAT(error_message([] { read("mse_dbs = true"); }), HasSubstr("did you mean \"mse_db\""));
}

}  // namespace
}  // namespace truebearing::mse_metrics_test
