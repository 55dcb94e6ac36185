// SPDX-License-Identifier: Apache-2.0
#include "truebearing/evaluation/text_table.hpp"

#include <gtest/gtest.h>

#include <sstream>
#include <string>

namespace truebearing::text_table_test {
namespace {

const Rows kRows{{"tracker", "position RMSE m", "+-", "velocity RMSE m/s", "+-"},
                 {"plain", "127.9", "1.944", "31.62", "0.579"},
                 {"tuned", "82.85", "0.334", "22.00", "0.236"}};

TEST(TextTable, SmallErrorsKeepThreeDigits) {
  EXPECT_EQ(fine_figure(0.09764), "0.0976");
  EXPECT_EQ(fine_figure(0.1234), "0.123");
  EXPECT_EQ(fine_figure(-0.000312), "-0.000312");
  EXPECT_EQ(fine_figure(0.5), figure(0.5));
  EXPECT_EQ(fine_figure(0.0), "0.000");
  EXPECT_EQ(fine_figure(1e-9), "0.000");
}

TEST(TextTable, WithoutAWidthIsOneBlock) {
  EXPECT_EQ(aligned(kRows),
            "tracker  position RMSE m     +-  velocity RMSE m/s     +-\n"
            "plain              127.9  1.944              31.62  0.579\n"
            "tuned              82.85  0.334              22.00  0.236\n");
}

TEST(TextTable, WhatDoesNotFitGoesOnBelowAndKeepsItsErrorBesideIt) {
  const std::string table = aligned(kRows, {.width = 40});
  EXPECT_EQ(table,
            "tracker  position RMSE m     +-\n"
            "plain              127.9  1.944\n"
            "tuned              82.85  0.334\n"
            "\n"
            "tracker  velocity RMSE m/s     +-\n"
            "plain                31.62  0.579\n"
            "tuned                22.00  0.236\n");
  EXPECT_EQ(aligned(kRows, {.width = 57}), aligned(kRows)) << "it just fits";
  EXPECT_NE(aligned(kRows, {.width = 56}), aligned(kRows));
}

TEST(TextTable, InMarkdownHasAHeadingAndOneForEachPart) {
  EXPECT_EQ(aligned({{"tracker", "RMSE"}, {"plain", "1"}}, {.markdown = true}),
            "| tracker | RMSE |\n|---|---:|\n| plain | 1 |\n");
  EXPECT_EQ(aligned({{"position", "1 s"}, {"  plain", "2"}, {"velocity", "1 s"}, {"  plain", "3"}}, {.markdown = true}),
            "| position | 1 s |\n|---|---:|\n| plain | 2 |\n\n| velocity | 1 s |\n|---|---:|\n| plain | 3 |\n");
}

TEST(TextTable, TheBestIsMarked) {
  EXPECT_EQ(marked("1.5", true, {}), "1.5*");
  EXPECT_EQ(marked("1.5", false, {}), "1.5 ");
  EXPECT_EQ(marked("1.5", true, {.markdown = true}), "**1.5**");
  EXPECT_EQ(marked("1.5", false, {.markdown = true}), "1.5");
}

}  // namespace
}  // namespace truebearing::text_table_test
