// SPDX-License-Identifier: Apache-2.0
#include "truebearing/io/table_reader.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/error_message.hpp"

namespace truebearing::table_reader_test {
namespace {

using ::testing::AllOf;
using testing::error_message;
using ::testing::HasSubstr;
using ::testing::Not;

/// The message of what `read` does with a table of this text.
template <typename Read>
std::string error_of(const std::string& text, const Read& read) {
  return error_message([&] {
    const SharedTable table = parse_toml(text, "study.toml");
    TableReader reader(table, "study.toml");
    read(reader);
  });
}

std::string parse_error_of(const std::string& text) {
  return error_message([&] { parse_toml(text, "study.toml"); });
}

std::string nested(std::size_t depth) {
  return "a = " + std::string(depth, '[') + std::string(depth, ']');
}

TEST(TableReader, UnknownKeySuggestsTheNearest) {
  const std::string message = error_of("steps = 1\nperoid_s = 2.0\n", [](TableReader& table) {
    table.integer("steps", 1, 10);
    table.number_or("period_s", 1.0);
    table.finish();
  });
  EXPECT_THAT(message, AllOf(HasSubstr("study.toml:2: peroid_s"), HasSubstr("did you mean \"period_s\"")));
}

TEST(TableReader, WhatIsTakenOverNeedNotBeAskedFor) {
  const SharedTable whole = parse_toml("a = 1\n[sub]\nb = 1\nc = 1\n", "study.toml");
  const auto finish = [&](const std::string& own) {
    return error_message([&] {
      TableReader reader(whole, "study.toml", "", parse_toml(own, "study.toml"));
      TableReader sub = reader.table("sub");
      sub.number("b");
      sub.finish();
      reader.finish();
    });
  };
  EXPECT_EQ(finish("sub = { b = 1 }"), "no error");
  EXPECT_EQ(finish(""), "no error");
  EXPECT_THAT(finish("sub = { c = 1 }"), HasSubstr("sub.c: is not a known key"));
  EXPECT_THAT(finish("a = 1"), HasSubstr("a: is not a known key"));
}

TEST(TableReader, UnknownKeyInASubTableNamesItsPath) {
  const std::string message = error_of("[sensor]\nsigma = 1\n", [](TableReader& table) {
    TableReader sensor = table.table("sensor");
    sensor.number_or("sigma_m", 1.0);
    sensor.finish();
  });
  EXPECT_THAT(message, AllOf(HasSubstr("study.toml:2: sensor.sigma"), HasSubstr("sigma_m")));
}

TEST(TableReader, WrongTypeSaysWhatItIs) {
  const auto number = [](TableReader& table) { table.number("a"); };
  EXPECT_THAT(error_of("a = \"1\"", number), AllOf(HasSubstr("study.toml:1: a"), HasSubstr("is text")));
  EXPECT_THAT(error_of("a = true", number), HasSubstr("is true or false"));
  EXPECT_THAT(error_of("a = [1]", number), HasSubstr("is an array"));
  EXPECT_THAT(error_of("a = 1979-05-27", number), HasSubstr("is a date"));
  EXPECT_THAT(error_of("a = 1.5", [](TableReader& table) { table.integer("a", 0, 9); }), HasSubstr("is a number"));
  EXPECT_THAT(error_of("a = 1", [](TableReader& table) { table.text("a"); }), HasSubstr("is an integer"));
  EXPECT_THAT(error_of("a = 1", [](TableReader& table) { table.boolean_or("a", true); }), HasSubstr("is an integer"));
  EXPECT_THAT(error_of("a = 1", [](TableReader& table) { table.table("a"); }), HasSubstr("valid: a table"));
}

TEST(TableReader, OutOfRangeSaysTheRange) {
  const auto positive = [](TableReader& table) { table.number("a", kPositive); };
  EXPECT_THAT(error_of("a = 0", positive), AllOf(HasSubstr("is 0"), HasSubstr("> 0")));
  EXPECT_THAT(error_of("a = nan", positive), HasSubstr("is nan"));
  EXPECT_THAT(error_of("a = inf", [](TableReader& table) { table.number("a"); }), HasSubstr("a finite number"));
  EXPECT_EQ(error_of("a = 0", [](TableReader& table) { table.number("a", kNonNegative); }), "no error");
  EXPECT_THAT(error_of("a = 11", [](TableReader& table) { table.integer("a", 1, 10); }), HasSubstr("[1, 10]"));
}

TEST(TableReader, MissingKeyIsNamed) {
  EXPECT_THAT(error_of("b = 1", [](TableReader& table) { table.number("a"); }), HasSubstr("a: is missing"));
}

TEST(TableReader, MissingKeySaysWhatWouldBeValid) {
  const auto ends_in = [](const std::string& valid) { return ::testing::EndsWith("is missing; valid: " + valid); };
  EXPECT_THAT(error_of("", [](TableReader& table) { table.number("a", kPositive); }), ends_in("a number > 0"));
  EXPECT_THAT(error_of("", [](TableReader& table) { table.integer("a", 1, 9); }), ends_in("an integer in [1, 9]"));
  EXPECT_THAT(error_of("", [](TableReader& table) { table.text("a"); }), ends_in("text in quotes"));
  EXPECT_THAT(error_of("", [](TableReader& table) { table.choice("a", {"b", "c"}); }), ends_in("one of \"b\", \"c\""));
  EXPECT_THAT(error_of("", [](TableReader& table) { table.numbers("a", 2, kNonNegative); }),
              ends_in("2 numbers, each a number >= 0"));
  EXPECT_THAT(error_of("", [](TableReader& table) { table.texts("a"); }), ends_in("an array of texts"));
  EXPECT_THAT(error_of("", [](TableReader& table) { table.table("a"); }), ends_in("a table"));
}

TEST(TableReader, MissingKeyNamesTheOneThatItWasMeantBy) {
  const auto period = [](TableReader& table) {
    table.has("periods");
    table.number("period_s", kPositive);
  };
  EXPECT_THAT(error_of("perod_s = 1", period), HasSubstr("a number > 0 (did you mean it by \"perod_s\"?)"));
  EXPECT_THAT(error_of("Period-s = 1", period), HasSubstr("did you mean it by \"Period-s\"?"));
  EXPECT_THAT(error_of("sigma_m = 1", period), Not(HasSubstr("did you mean")));
  EXPECT_THAT(error_of("periods = 1", period), Not(HasSubstr("did you mean"))) << "it is a key of its own";
}

TEST(TableReader, TellsWhichOfTwoKeysItHas) {
  std::string had;
  const auto which = [&](TableReader& table) { had = table.one_of("to_deg", "by_deg"); };
  EXPECT_EQ(error_of("by_deg = 1", which), "no error");
  EXPECT_EQ(had, "by_deg");
  EXPECT_EQ(error_of("to_deg = 1", which), "no error");
  EXPECT_EQ(had, "to_deg");
  EXPECT_THAT(error_of("to_deg = 1\nby_deg = 1", which),
              HasSubstr("has both to_deg and by_deg; valid: one of the two"));
  EXPECT_THAT(error_of("other = 1", which), HasSubstr("has neither to_deg nor by_deg; valid: one of the two"));
  EXPECT_THAT(error_of("bi_deg = 1", which), HasSubstr("(did you mean it by \"bi_deg\"?)"));
}

TEST(TableReader, ChoiceListsTheValidNames) {
  EXPECT_THAT(error_of("a = \"plan\"",
                       [](TableReader& table) {
                         table.choice("a", {"range", "plane"});
                       }),
              AllOf(HasSubstr("is \"plan\""), HasSubstr("did you mean \"plane\"")));
}

TEST(TableReader, ArraysHaveTheSizeAskedFor) {
  const auto two = [](TableReader& table) { EXPECT_EQ(table.numbers("a", 2), (std::vector<double>{1.0, 2.5})); };
  EXPECT_EQ(error_of("a = [1, 2.5]", two), "no error");
  EXPECT_THAT(error_of("a = [1, 2, 3]", two), HasSubstr("holds 3 numbers"));
  EXPECT_THAT(error_of("a = [1, \"2\"]", two), HasSubstr("holds text"));
}

TEST(TableReader, KeysStandInTheOrderOfTheFile) {
  const SharedTable table = parse_toml("z = 1\na = 2\nm = 3\n", "study.toml");
  EXPECT_THAT(TableReader(table, "study.toml").keys(), ::testing::ElementsAre("z", "a", "m"));
}

TEST(Toml, SyntaxErrorNamesTheLine) {
  EXPECT_THAT(parse_error_of("a = 1\nb = = 2\n"), HasSubstr("study.toml:2"));
}

TEST(Toml, KeyMayStandOnce) {
  EXPECT_THAT(parse_error_of("a = 1\na = 2\n"), HasSubstr("study.toml:2"));
}

TEST(Toml, DepthIsLimited) {
  EXPECT_EQ(parse_error_of(nested(64)), "no error");
  EXPECT_THAT(parse_error_of(nested(65)), HasSubstr("nested too deeply"));
  EXPECT_THAT(parse_error_of("a = " + std::string(1'000'000, '[')), HasSubstr("nested too deeply"));
}

TEST(Toml, DepthOfDottedKeysIsLimited) {
  std::string dotted = "a";
  for (int i = 1; i < 64; ++i) dotted += ".a";
  EXPECT_EQ(parse_error_of(dotted + " = 1"), "no error");
  EXPECT_THAT(parse_error_of(dotted + ".a = 1"), HasSubstr("nested too deeply"));
  for (int i = 0; i < 500'000; ++i) dotted += ".a";
  EXPECT_THAT(parse_error_of(dotted + " = 1"), HasSubstr("nested too deeply"));
}

TEST(Toml, DotsAndBracketsInTextAreNoDepth) {
  const std::string dots(100, '.'), brackets(100, '[');
  for (const char* quote : {"\"", "'", "\"\"\"", "'''"})
    EXPECT_EQ(parse_error_of("a = " + (quote + dots + brackets) + quote + " # " + dots + brackets), "no error")
        << quote;
  EXPECT_EQ(parse_error_of("a = \"\\\"" + brackets + "\"\nb = \"\"\"\n\"\"" + brackets + "\"\"\"\n"), "no error");
  EXPECT_THAT(parse_error_of("a = \"\\\\\"\nb = " + brackets), HasSubstr("nested too deeply"));
}

// The last quotes of such a text are its own characters, not the beginning of another.
TEST(Toml, QuotesAtTheEndOfATextHideNoDepth) {
  std::string dotted = "a";
  for (int i = 0; i < 130'000; ++i) dotted += ".a";
  for (const char* text : {"\'\'\'x\'\'\'\'", "\'\'\'x\'\'\'\'\'", "\"\"\"x\"\"\"\"", "\"\"\"x\"\"\"\"\"",
                           "\"\"\"\\\"\"\"\"", "''", "\'\'\'\'\'\'"}) {
    const std::string before = std::string("t = ") + text + "\n";
    EXPECT_EQ(parse_error_of(before), "no error") << text;
    EXPECT_THAT(parse_error_of(before + dotted + " = 1"), HasSubstr("nested too deeply")) << text;
  }
  EXPECT_EQ(parse_error_of("t = \'\'\'x\'\'\'\'\nu = \"" + std::string(100, '.') + "\""), "no error");
}

TEST(Toml, SizeIsLimited) {
  const std::string line = "a = 1\n#";
  EXPECT_EQ(parse_error_of(line + std::string((std::size_t{1} << 20) - line.size(), 'x')), "no error");
  EXPECT_THAT(parse_error_of(line + std::string((std::size_t{1} << 20) + 1 - line.size(), 'x')), HasSubstr("at most"));
}

}  // namespace
}  // namespace truebearing::table_reader_test
