// SPDX-License-Identifier: Apache-2.0
#include "truebearing/correction/rule_report.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/correction_models.hpp"

namespace truebearing::rule_report_test {
namespace {

using ::testing::HasSubstr;

TEST(RuleReport, WordsOfAnEvenFeatureAreSizes) {
  EXPECT_EQ(term_word(-2.0, 1), "VERY SMALL");
  EXPECT_EQ(term_word(-1.0, 1), "SMALL");
  EXPECT_EQ(term_word(0.0, 1), "MEDIUM");
  EXPECT_EQ(term_word(1.0, 1), "LARGE");
  EXPECT_EQ(term_word(2.0, 1), "VERY LARGE");
}

TEST(RuleReport, WordsOfAnOddFeatureHaveASign) {
  EXPECT_EQ(term_word(0.1, -1), "NEAR ZERO");
  EXPECT_EQ(term_word(-0.5, -1), "SMALL NEGATIVE");
  EXPECT_EQ(term_word(1.0, -1), "POSITIVE");
  EXPECT_EQ(term_word(-3.0, -1), "LARGE NEGATIVE");
}

// Two rules so far apart that each speaks for itself at its centre.
TEST(RuleReport, SentencesSayConditionsOutputUsageAndTeacher) {
  FuzzyNetwork::Parameters parameters{.input_mean = Eigen::Vector2d(0.5, 0.0),
                                      .input_scale = Eigen::Vector2d(0.1, 1000.0),
                                      .input_clip = 40.0,
                                      .centres = Eigen::MatrixXd(2, 2),
                                      .widths = Eigen::MatrixXd::Constant(2, 2, 0.1),
                                      .consequents = Eigen::MatrixXd(2, 2),
                                      .output_scale = Eigen::Vector2d(1000.0, 100.0)};
  parameters.centres << -2.0, -3.0, 0.0, 3.0;
  parameters.consequents << -1.0, -0.5, 2.89, 1.52;
  CorrectionModel model = testing::line_model(
      {{.kind = FeatureKind::gain, .component = "position_m"},
       {.kind = FeatureKind::companion_difference, .component = "velocity_mps", .companion = "wide", .scale = 1.0}},
      parameters);
  model.rules().usage = Eigen::Vector2d(0.25, 0.75);
  model.rules().local_mean << -900.0, -45.0, 2710.0, 140.0;
  EXPECT_EQ(
      rule_sentences(model),
      "1. IF gain in position_m is MEDIUM AND difference of wide in velocity_mps is LARGE POSITIVE THEN add +2890 m, "
      "+152 m/s   (usage 75.0 %, teacher's mean +2710 m, +140 m/s)\n"
      "2. IF gain in position_m is VERY SMALL AND difference of wide in velocity_mps is LARGE NEGATIVE THEN add -1000 m, "
      "-50 m/s   (usage 25.0 %, teacher's mean -900 m, -45 m/s)\n");
}

TEST(RuleReport, EveryRuleHasOneSentence) {
  RandomStream random({}, StreamId::test);
  const CorrectionModel model = testing::line_model(
      testing::radar_features(), testing::random_parameters(random, 4, 16, 2), "plain", "tuned", "wide");
  const std::string text = rule_sentences(model);
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 16);
  EXPECT_THAT(text, HasSubstr("16. IF ln step is"));
}

}  // namespace
}  // namespace truebearing::rule_report_test
