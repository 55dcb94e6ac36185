// SPDX-License-Identifier: Apache-2.0
#include "truebearing/io/json_lines.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <sstream>

#include "tests/support/error_message.hpp"
#include "tests/support/temporary_folder.hpp"
#include "truebearing/io/csv.hpp"

namespace truebearing::json_lines_test {
namespace {

using ::testing::AllOf;
using testing::error_message;
using ::testing::HasSubstr;

std::string csv_of(const std::string& text) {
  std::istringstream stream(text);
  return csv_of_json_lines(stream, "log.jsonl");
}

TEST(JsonLines, AreTheTableThatSaysTheSame) {
  EXPECT_EQ(csv_of("{\"time_s\": 1, \"range_m\": 5e3}\n{\"range_m\": null, \"time_s\": 2.5, \"sensor\": \"a, b\"}\n"),
            "time_s,range_m,sensor\n1,5000.0,\n2.5,,\"a, b\"\n");
}

TEST(JsonLines, ReadAsAnyOtherLog) {
  const testing::TemporaryFolder folder;
  CsvReader csv(folder.write("log.jsonl", "{\"time_s\": 1, \"range_m\": 5}\n\n{\"time_s\": 2}\n"));
  ASSERT_TRUE(csv.next());
  EXPECT_EQ(csv.number(csv.required_column("range_m")), 5.0);
  EXPECT_EQ(csv.line(), 1u);
  ASSERT_TRUE(csv.next());
  EXPECT_TRUE(std::isnan(csv.number(csv.required_column("range_m"))));
  EXPECT_EQ(csv.line(), 3u);
  EXPECT_FALSE(csv.next());
}

TEST(JsonLines, MistakesNameTheirLine) {
  const auto error_of = [](const std::string& text) { return error_message([&] { csv_of(text); }); };
  EXPECT_THAT(error_of("{\"time_s\": 1}\n{\"time_s\": 2\n"), AllOf(HasSubstr("log.jsonl:2"), HasSubstr("an object")));
  EXPECT_THAT(error_of("[1, 2]\n"), HasSubstr("log.jsonl:1"));
  EXPECT_THAT(error_of("{\"time_s\": 1, \"at\": {\"x\": 1}}\n"),
              AllOf(HasSubstr("log.jsonl:1: at"), HasSubstr("no number")));
  EXPECT_THAT(error_of("\n\n"), HasSubstr("has no lines"));
  EXPECT_THAT(error_of("{\"time_s\": 1e999}\n"), HasSubstr("log.jsonl:1"));
}

}  // namespace
}  // namespace truebearing::json_lines_test
