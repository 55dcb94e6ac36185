// SPDX-License-Identifier: Apache-2.0
#include "truebearing/io/json_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>

#include "tests/support/error_message.hpp"

namespace truebearing::json_file_test {
namespace {

using ::testing::AllOf;
using testing::error_message;
using ::testing::HasSubstr;

std::string nested(std::size_t depth) {
  return std::string(depth, '[') + std::string(depth, ']');
}

std::string error_of(const std::string& text, JsonLimits limits = {}) {
  return error_message([&] { parse_json(text, "model.json", limits); });
}

TEST(JsonFile, WhatIsWrittenReadsBack) {
  nlohmann::ordered_json value;
  value["z"] = 0.1;
  value["a"] = {1, 2, -1.0 / 3.0};
  const std::string text = json_text(value);
  EXPECT_EQ(text.back(), '\n');
  EXPECT_LT(text.find("\"z\""), text.find("\"a\""));
  const nlohmann::json read = parse_json(text, "model.json");
  EXPECT_EQ(read["z"].get<double>(), 0.1);
  EXPECT_EQ(read["a"][2].get<double>(), -1.0 / 3.0);
}

TEST(JsonFile, NonFiniteNumbersAreWrittenAsNull) {
  const nlohmann::ordered_json value = {std::numeric_limits<double>::quiet_NaN(),
                                        std::numeric_limits<double>::infinity(), 1};
  EXPECT_EQ(json_text(value), "[\n  null,\n  null,\n  1\n]\n");
}

TEST(JsonFile, SyntaxErrorNamesTheLine) {
  EXPECT_THAT(error_of("{\n\"a\": 1,\n}\n"), AllOf(HasSubstr("model.json:3: "), HasSubstr("syntax error")));
  EXPECT_THAT(error_of(""), HasSubstr("model.json:1: "));
  EXPECT_THAT(error_of("[1] 2"), HasSubstr("model.json:1: "));
  EXPECT_THAT(error_of("[NaN]"), HasSubstr("model.json:1: "));
  EXPECT_THAT(error_of("[\"\xff\"]"), HasSubstr("model.json:1: "));
  EXPECT_THAT(error_of("[1e999]"), AllOf(HasSubstr("model.json: "), HasSubstr("1e999")));
}

TEST(JsonFile, LongRubbishMakesAShortError) {
  EXPECT_LT(error_of(std::string(1'000'000, 'n')).size(), 300u);
}

TEST(JsonFile, DepthIsLimited) {
  EXPECT_EQ(error_of(nested(64)), "no error");
  EXPECT_THAT(error_of(nested(65)), AllOf(HasSubstr("nested too deeply"), HasSubstr("at most 64")));
  EXPECT_THAT(error_of(std::string(1'000'000, '[')), HasSubstr("nested too deeply"));
  EXPECT_THAT(error_of("{\"a\":{\"b\":1}}", {.max_depth = 1}), HasSubstr("nested too deeply"));
}

TEST(JsonFile, SizeIsLimited) {
  EXPECT_EQ(error_of("[1]", {.max_bytes = 3}), "no error");
  EXPECT_THAT(error_of("[1] ", {.max_bytes = 3}), AllOf(HasSubstr("too large"), HasSubstr("at most 3 bytes")));
}

TEST(JsonFile, KeyMayStandOnceInAnObject) {
  EXPECT_THAT(error_of(R"({"a": 1, "b": [{"c": 1, "c": 2}]})"), HasSubstr("\"c\" twice"));
  EXPECT_EQ(error_of(R"({"a": {"a": 1}, "b": [{"a": 1}, {"a": 1}]})"), "no error");
}

TEST(JsonFile, MissingFileIsAnError) {
  EXPECT_THAT(error_message([] { read_json_file("/nonexistent/m.json"); }), HasSubstr("/nonexistent/m.json"));
}

}  // namespace
}  // namespace truebearing::json_file_test
