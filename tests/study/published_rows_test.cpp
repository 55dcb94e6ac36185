// SPDX-License-Identifier: Apache-2.0
#include "truebearing/study/published_rows.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/support/error_message.hpp"
#include "tests/support/radar_study.hpp"
#include "truebearing/evaluation/report.hpp"
#include "truebearing/study/study.hpp"

namespace truebearing::published_rows_test {
namespace {

using ::testing::AllOf;
using ::testing::ContainsRegex;
using testing::error_message;
using ::testing::HasSubstr;
using testing::kStudy;
using testing::replaced;
using testing::TemporaryFolder;
using testing::write_study;

constexpr const char* kRow =
    "[[published]]\nname = \"a paper's\"\nsource = \"A. Nonymous 1960, table 1\"\nposition_m = 123.0\nmse_db = -4.5\n";

// The small study with those rows, and without its correction.
std::string study(const std::string& rows, const std::string& sets = "") {
  std::string text = replaced(kStudy, "pairs = [\"nfnn - tuned\"]", "mse_db = true");
  text.resize(text.find("[trackers.nfnn]"));
  return text + sets + rows;
}

Comparison compared(const std::string& text, bool on_records = false) {
  const TemporaryFolder folder;
  const Study read = Study::load(write_study(folder, text));
  ComparisonOptions options = read.comparison_options(on_records);
  options.runs = 2;
  return compare(read.make_tracker_set(), read.evaluation_scenarios(), options);
}

std::string refusal(const std::string& rows, const std::string& sets = "") {
  const TemporaryFolder folder;
  return error_message([&] { Study::load(write_study(folder, study(rows, sets))); });
}

TEST(PublishedRows, StandInTheTablesThatHaveTheirFigures) {
  const Comparison comparison = compared(study(kRow));
  const std::string table = comparison_table(comparison);
  EXPECT_THAT(table, ContainsRegex("a paper's \\(published\\) +123\\.0 "));
  EXPECT_THAT(table, HasSubstr("a paper's (published)  -4.500"));
  EXPECT_THAT(table, HasSubstr("\na paper's (published): A. Nonymous 1960, table 1\n"));
  const auto json = nlohmann::json::parse(comparison_json(comparison));
  EXPECT_EQ(json["published"],
            (nlohmann::json{
                {"a paper's", {{"source", "A. Nonymous 1960, table 1"}, {"position_m", 123.0}, {"mse_db", -4.5}}}}));
  EXPECT_FALSE(nlohmann::json::parse(comparison_json(compared(study("")))).contains("published"));
}

TEST(PublishedRows, AFigureMayBeOfEachSet) {
  const std::string sets = "[sets]\nshort = { steps = 10 }\nlong = { steps = 20 }\n";
  const Comparison comparison = compared(
      study("[[published]]\nname = \"x\"\nsource = \"s\"\nnees = { short = 2.5, long = 3.5 }\nmse_db = 7\n", sets));
  const auto json = nlohmann::json::parse(comparison_json(comparison));
  EXPECT_EQ(json["sets"]["short"]["published"]["x"]["nees"], 2.5);
  EXPECT_EQ(json["sets"]["long"]["published"]["x"]["nees"], 3.5);
  EXPECT_EQ(json["published"]["x"], (nlohmann::json{{"source", "s"}, {"mse_db", 7.0}})) << "of all sets together";
  const std::string table = comparison_table(comparison);
  EXPECT_EQ(table.find("x (published): s"), table.rfind("x (published): s")) << "a source is printed once";
}

TEST(PublishedRows, AreNotOfARecordedTrack) {
  EXPECT_TRUE(compared(study(kRow), true).published.empty());
}

TEST(PublishedRows, WhatTheComparisonDoesNotHaveIsRefused) {
  const std::string row = "[[published]]\nname = \"x\"\nsource = \"s\"\n";
  EXPECT_EQ(refusal(row + "mse_db = -1.0\nvelocity_mps = 3.0\nnees = 2.0\n"), "no error");
  EXPECT_THAT(refusal(row + "mse_dB = -1.0\n"), AllOf(HasSubstr("published[0].mse_dB: is no figure of this comparison"),
                                                      HasSubstr("did you mean \"mse_db\"")));
  EXPECT_THAT(refusal(row + "position_peak_error = 1.0\n"), HasSubstr("is no figure of this comparison"));
  EXPECT_THAT(refusal(row), AllOf(HasSubstr("published[0]"), HasSubstr("holds no figure")));
  EXPECT_THAT(refusal(row + "nees = { short = 1.0 }\n"),
              AllOf(HasSubstr("published[0].nees.short: is no set of the study"), HasSubstr("it has no sets")));
  EXPECT_THAT(refusal(row + "nees = { shrt = 1.0 }\n", "[sets]\nshort = { steps = 10 }\n"),
              HasSubstr("did you mean \"short\""));
  EXPECT_THAT(refusal(row + "nees = 1.0\n" + row + "nees = 1.0\n"),
              AllOf(HasSubstr("published[1].name: is \"x\" once more"), HasSubstr("a name that no other row has")));
  EXPECT_THAT(refusal("[[published]]\nname = \"x\"\nnees = 1.0\n"), HasSubstr("published[0].source: is missing"));
  EXPECT_THAT(refusal(row + "nees = \"two\"\n"), HasSubstr("published[0].nees: is text"));
}

}  // namespace
}  // namespace truebearing::published_rows_test
