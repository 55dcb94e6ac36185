// SPDX-License-Identifier: Apache-2.0
#include "truebearing/io/csv.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <sstream>

#include "tests/support/error_message.hpp"

namespace truebearing::csv_test {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using testing::error_message;
using ::testing::HasSubstr;
using Rows = std::vector<std::vector<std::string>>;

Rows read_all(const std::string& text) {
  std::istringstream stream(text);
  CsvReader csv(stream, "log.csv");
  Rows rows{csv.header()};
  while (csv.next()) {
    rows.emplace_back();
    for (std::size_t i = 0; i < csv.header().size(); ++i) rows.back().emplace_back(csv.text(i));
  }
  return rows;
}

std::string error_of(const std::string& text) {
  return error_message([&] { read_all(text); });
}

double number_of(const std::string& cell) {
  std::istringstream stream("a,b\n1," + cell + "\n");
  CsvReader csv(stream, "log.csv");
  csv.next();
  return csv.number(1);
}

TEST(CsvReader, LineEndsAndByteOrderMarkMakeNoDifference) {
  const Rows expected{{"a", "b"}, {"1", "2"}, {"3", ""}};
  EXPECT_EQ(read_all("a,b\n1,2\n3,\n"), expected);
  EXPECT_EQ(read_all("a,b\r\n1,2\r\n3,\r\n"), expected);
  EXPECT_EQ(read_all("\xEF\xBB\xBF"
                     "a,b\n1,2\n3,"),
            expected);
  EXPECT_EQ(read_all("\xEF\xBB\xBF\"a\", b \n\n1,2\r\n\r\n3,\r"), expected);
}

TEST(CsvReader, QuotedCellsHoldAnything) {
  EXPECT_EQ(read_all("a,b\n\"x, \"\"y\"\"\n z\",2\n"), (Rows{{"a", "b"}, {"x, \"y\"\n z", "2"}}));
}

TEST(CsvReader, HeaderMustNameEveryColumnOnce) {
  EXPECT_THAT(error_of(""), AllOf(HasSubstr("log.csv"), HasSubstr("is empty")));
  EXPECT_THAT(error_of("a,,c\n"), AllOf(HasSubstr("log.csv:1"), HasSubstr("column 2")));
  EXPECT_THAT(error_of("a,b,a\n"), HasSubstr("\"a\" twice"));
  EXPECT_THAT(error_of("\xEF\xFF"), HasSubstr("does not begin with text"));
}

TEST(CsvReader, RowOfAnotherLengthIsAnErrorWithItsLine) {
  EXPECT_THAT(error_of("a,b\n1,2\n\n3\n"), AllOf(HasSubstr("log.csv:4"), HasSubstr("1 cells"), HasSubstr("2, as")));
  EXPECT_THAT(error_of("a,b\n\"1\n\",2\n1,2,3\n"), AllOf(HasSubstr("log.csv:4"), HasSubstr("3 cells")));
}

TEST(CsvReader, BrokenQuotesAreErrors) {
  EXPECT_THAT(error_of("a,b\n1,\"2\n"), AllOf(HasSubstr("log.csv:2"), HasSubstr("not closed")));
  EXPECT_THAT(error_of("a,b\n1,\"2\"3\n"), AllOf(HasSubstr("log.csv:2"), HasSubstr("closing quote")));
}

TEST(CsvReader, LineHasALimit) {
  constexpr std::size_t kLimit = std::size_t{1} << 20;
  EXPECT_EQ(read_all("a\n" + std::string(kLimit, '1') + "\n")[1][0].size(), kLimit);
  EXPECT_THAT(error_of("a\n" + std::string(kLimit + 1, '1') + "\n"), HasSubstr("log.csv:2: is too long"));
  EXPECT_THAT(error_of("a\n" + std::string(kLimit + 1, ',') + "\n"), HasSubstr("log.csv:2: is too long"));
}

TEST(CsvReader, NumbersAreReadExactly) {
  EXPECT_EQ(number_of("0.1"), 0.1);
  EXPECT_EQ(number_of("+4"), 4.0);
  EXPECT_EQ(number_of(" -1e-3\t"), -1e-3);
  EXPECT_EQ(number_of("\"5\""), 5.0);
}

TEST(CsvReader, MissingNumbersAreNaN) {
  for (const char* cell : {"", "  ", "nan", "NaN", "-nan", "inf", "-Infinity", "INF"})
    EXPECT_TRUE(std::isnan(number_of(cell))) << '"' << cell << '"';
}

TEST(CsvReader, TextWhereANumberBelongsIsAnError) {
  for (const char* cell : {"abc", "1.5m", "1,5", "1 2", "--1", "+-1", "0x10", "1e999"})
    EXPECT_THAT(error_message([&] { number_of('"' + std::string(cell) + '"'); }),
                AllOf(HasSubstr("log.csv:2: b"), HasSubstr(cell), HasSubstr("valid: a number")));
}

TEST(CsvReader, WordsForMissingAreNaN) {
  for (const char* cell : {"NA", "N/A", "null", "NULL", "None", "-", "1.#QNAN", "-1.#IND00", "1.#INF", "NaT", "#N/A"})
    EXPECT_TRUE(std::isnan(number_of(cell))) << '"' << cell << '"';
}

TEST(CsvReader, NumbersTooSmallAreZero) {
  EXPECT_EQ(number_of("1e-400"), 0.0);
  EXPECT_EQ(number_of("0." + std::string(400, '0') + "1"), 0.0);
}

TEST(CsvReader, SeparatorIsTheOneThatTheHeaderHasMostOf) {
  const Rows expected{{"a", "b"}, {"1", "2"}};
  EXPECT_EQ(read_all("a;b\n1;2\n"), expected);
  EXPECT_EQ(read_all("a\tb\n1\t2\n"), expected);
  EXPECT_EQ(read_all("sep=;\r\na;b\r\n1;2\r\n"), expected);
  EXPECT_EQ(read_all("sep=,\na,b\n1,2\n"), expected);
  EXPECT_EQ(read_all("sep=|\na|b\n1|2\n"), expected);
  EXPECT_EQ(read_all("a;b;c, d\n1;2;3\n")[0], (std::vector<std::string>{"a", "b", "c, d"}));
}

TEST(CsvReader, CommentsAndLineEndsOfOldAreRead) {
  const Rows expected{{"a", "b"}, {"1", "2"}, {"3", "4"}};
  EXPECT_EQ(read_all("# made by \"hand\"\n\na,b\n#\n1,2\n# more\n3,4\n# end"), expected);
  EXPECT_EQ(read_all("a,b\r1,2\r3,4\r"), expected);
  EXPECT_THAT(error_of("# one\na,b\n# two\n1\n"), HasSubstr("log.csv:4"));
}

TEST(CsvReader, DecimalCommasWhereTheCommaSeparatesNothing) {
  const auto numbers = [](const std::string& text) {
    std::istringstream stream(text);
    CsvReader csv(stream, "log.csv");
    std::vector<double> values;
    while (csv.next()) values.push_back(csv.number(0));
    return values;
  };
  EXPECT_THAT(numbers("a;b\n1,5;x\n-2,25;x\n3;x\n"), ElementsAre(1.5, -2.25, 3.0));
  EXPECT_THAT(error_message([&] { numbers("a;b\n1,5;x\n2.5;x\n"); }), HasSubstr("log.csv:3: a"));
  EXPECT_THAT(error_message([&] { numbers("a;b\n1.234,5;x\n"); }), HasSubstr("log.csv:2: a"));
}

TEST(CsvReader, WhatIsNoTextIsRefused) {
  EXPECT_THAT(error_of(std::string("\xFF\xFE"
                                   "a\0",
                                   4)),
              HasSubstr("UTF-16"));
  EXPECT_THAT(error_of(std::string("a\0,\0b\0", 6)), HasSubstr("zero byte"));
}

TEST(CsvReader, LongAndWildHeadersMakeOneShortLine) {
  for (const std::string& header :
       {std::string(900'000, 'x') + ",b", std::string("\x1b[2J,b"), std::string("a\"\n,b")}) {
    std::istringstream stream(header + "\n1,2\n");
    const std::string message = error_message([&] { CsvReader(stream, "log.csv").required_column("time_s"); });
    EXPECT_LE(message.size(), 187u);
    EXPECT_EQ(message.find_first_of("\x1b\n"), message.npos) << message;
    EXPECT_THAT(message, HasSubstr("log.csv"));
  }
}

TEST(CsvReader, ErrorShowsNoControlCharactersAndNoLongText) {
  const std::string message = error_message([] { number_of("\x1b[2J" + std::string(1000, 'x')); });
  EXPECT_EQ(message.find('\x1b'), std::string::npos);
  EXPECT_LT(message.size(), 200u);
}

TEST(CsvReader, ColumnsAreFoundByName) {
  std::istringstream stream("time_s,position_m\n");
  const CsvReader csv(stream, "log.csv");
  EXPECT_EQ(csv.column("position_m"), 1);
  EXPECT_EQ(csv.column("position"), -1);
  EXPECT_THAT(error_message([&] { csv.required_column("tim_s"); }), HasSubstr("did you mean \"time_s\""));
}

TEST(CsvReader, FileThatCannotBeReadIsAnError) {
  EXPECT_THAT(error_message([] { CsvReader("/nonexistent/log.csv"); }),
              AllOf(HasSubstr("/nonexistent/log.csv"), HasSubstr("No such file")));
  EXPECT_THAT(error_message([] { CsvReader("/tmp"); }), HasSubstr("is a directory"));
}

TEST(CsvWriter, WritesWhatTheReaderReads) {
  CsvWriter csv({"name", "value, m"});
  const std::vector<double> values{0.1, -1.0 / 3.0, 5.0, 1e300, std::numeric_limits<double>::denorm_min(), -0.0};
  for (const double value : values) {
    csv.text("a \"b\", c\n");
    csv.number(value);
    csv.end_row();
  }
  std::istringstream stream(csv.str());
  CsvReader reader(stream, "log.csv");
  EXPECT_THAT(reader.header(), ElementsAre("name", "value, m"));
  for (const double value : values) {
    ASSERT_TRUE(reader.next());
    EXPECT_EQ(reader.text(0), "a \"b\", c\n");
    EXPECT_EQ(reader.number(1), value);
  }
  EXPECT_FALSE(reader.next());
}

TEST(CsvWriter, NumbersAreShortAndNaNIsEmpty) {
  CsvWriter csv({"a", "b", "c"});
  csv.number(5.0);
  csv.number(std::nan(""));
  csv.number(0.1);
  csv.end_row();
  EXPECT_EQ(csv.str(), "a,b,c\n5,,0.1\n");
}

TEST(CsvWriter, RowMustHaveTheHeadersLength) {
  CsvWriter csv({"a", "b"});
  csv.number(1.0);
  EXPECT_THROW(csv.end_row(), std::logic_error);
}

}  // namespace
}  // namespace truebearing::csv_test
