// SPDX-License-Identifier: Apache-2.0
#include "truebearing/simulation/distribution.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/support/error_message.hpp"
#include "tests/support/statistics.hpp"

namespace truebearing::distribution_test {
namespace {

using ::testing::AllOf;
using testing::counts_are_even;
using testing::error_message;
using ::testing::HasSubstr;
using Kind = Distribution::Kind;

constexpr std::size_t kDraws = 100'000;

Distribution read(const std::string& value, Range range = kAnyNumber) {
  const SharedTable table = parse_toml("a = " + value, "scenario.toml");
  TableReader reader(table, "scenario.toml");
  const Distribution distribution = read_distribution(reader, "a", range);
  reader.finish();
  return distribution;
}

std::string error_of(const std::string& value, Range range = kAnyNumber) {
  return error_message([&] { read(value, range); });
}

std::vector<double> draws(const Distribution& distribution) {
  RandomStream stream({1, Role::evaluation, 0}, StreamId::test);
  std::vector<double> values(kDraws);
  for (double& value : values) value = distribution.draw(stream);
  return values;
}

/// Are the draws, put through their distribution function, uniform?
template <typename Function>
bool follow(const std::vector<double>& values, const Function& distribution_function) {
  std::vector<int> counts(50);
  for (const double value : values) ++counts.at(static_cast<std::size_t>(50.0 * distribution_function(value)));
  return counts_are_even(counts);
}

TEST(Distribution, FixedIsItsValue) {
  EXPECT_TRUE(read("3").is_fixed());
  EXPECT_EQ(draws(read("3.5"))[17], 3.5);
  EXPECT_FALSE(read("{ uniform = [1, 2] }").is_fixed());
}

TEST(Distribution, DrawsFollowTheirLaw) {
  EXPECT_TRUE(follow(draws(read("{ uniform = [-400, 400] }")), [](double x) { return (x + 400.0) / 800.0; }));
  const auto log_uniform = [](double x) { return std::log(x / 0.25) / std::log(16.0); };
  EXPECT_TRUE(follow(draws(read("{ log_uniform = [0.25, 4] }")), log_uniform));
  EXPECT_FALSE(follow(draws(read("{ uniform = [0.25, 3.99] }")), log_uniform)) << "the test sees no difference";
  EXPECT_TRUE(follow(draws(read("{ normal = [5, 1000] }")),
                     [](double x) { return 0.5 * std::erfc((5.0 - x) / 1000.0 / std::sqrt(2.0)); }));
}

TEST(Distribution, ChoiceIsEven) {
  const std::vector<double> values = draws(read("{ choice = [-600, 600, 7] }"));
  std::vector<int> counts;
  for (const double value : {-600.0, 600.0, 7.0})
    counts.push_back(static_cast<int>(std::count(values.begin(), values.end(), value)));
  EXPECT_EQ(counts[0] + counts[1] + counts[2], static_cast<int>(kDraws));
  EXPECT_TRUE(counts_are_even(counts));
}

TEST(Distribution, QuantileAndShareBelowUndoEachOther) {
  for (const char* value : {"{ uniform = [-400, 400] }", "{ normal = [5, 1000] }", "{ log_uniform = [0.25, 4] }"})
    for (const double u : {0.001, 0.3, 0.5, 0.999})
      EXPECT_NEAR(read(value).share_below(read(value).quantile(u)), u, 1e-9) << value;
  EXPECT_EQ(read("{ uniform = [1, 2] }").share_below(0.5), 0.0);
  EXPECT_EQ(read("{ uniform = [1, 2] }").share_below(2.5), 1.0);
  EXPECT_EQ(read("{ log_uniform = [1, 2] }").share_below(-1.0), 0.0);
}

TEST(Distribution, NoShareLiesBelowTheLeastOfSeparateValues) {
  const Distribution choice = read("{ choice = [5, 1, 3] }");
  EXPECT_EQ(choice.quantile(0.1), 1.0);
  EXPECT_EQ(choice.quantile(0.5), 3.0);
  EXPECT_EQ(choice.quantile(1.0), 5.0);
  EXPECT_EQ(choice.share_below(1.0), 0.0);
  EXPECT_NEAR(choice.share_below(3.5), 2.0 / 3.0, 1e-12);
  EXPECT_EQ(read("7").share_below(7.0), 0.0);
  EXPECT_EQ(read("7").share_below(7.1), 1.0);
  EXPECT_EQ(read("{ uniform = [2, 2] }").share_below(2.1), 1.0);
}

TEST(Distribution, EveryKindTakesOneNumberFromTheStream) {
  for (const char* value :
       {"1", "{ uniform = [1, 2] }", "{ normal = [1, 2] }", "{ log_uniform = [1, 2] }", "{ choice = [1, 2, 3] }"}) {
    RandomStream stream({1, Role::evaluation, 0}, StreamId::test), other = stream;
    read(value).draw(stream);
    other.uniform();
    EXPECT_EQ(stream.bits(), other.bits()) << value;
  }
}

TEST(Distribution, EndsMustLieInTheRange) {
  EXPECT_THAT(error_of("-1", kPositive), AllOf(HasSubstr("scenario.toml:1: a"), HasSubstr("> 0")));
  EXPECT_THAT(error_of("{ uniform = [0, 1] }", kPositive), AllOf(HasSubstr("a.uniform"), HasSubstr("> 0")));
  EXPECT_THAT(error_of("{ choice = [1, 2, -3] }", kPositive), HasSubstr("holds -3"));
  EXPECT_THAT(error_of("{ uniform = [0, inf] }"), HasSubstr("finite"));
  EXPECT_EQ(error_of("{ uniform = [0, 1] }", kNonNegative), "no error");
}

TEST(Distribution, NormalIsRefusedWhereTheRangeIsLimited) {
  EXPECT_THAT(error_of("{ normal = [5, 1] }", kPositive), HasSubstr("a normal distribution is not"));
}

TEST(Distribution, WhatIsNoDistributionIsAnError) {
  EXPECT_THAT(error_of("\"3\""), AllOf(HasSubstr("is not a number"), HasSubstr("{ uniform = [low, high] }")));
  EXPECT_THAT(error_of("[1, 2]"), HasSubstr("is not a number"));
  EXPECT_THAT(error_of("{ unifrom = [1, 2] }"), HasSubstr("did you mean \"uniform\""));
  EXPECT_THAT(error_of("{}"), HasSubstr("does not name one distribution"));
  EXPECT_THAT(error_of("{ uniform = [1, 2], choice = [1] }"), HasSubstr("does not name one distribution"));
  EXPECT_THAT(error_of("{ uniform = [2, 1] }"), HasSubstr("in this order"));
  EXPECT_THAT(error_of("{ uniform = [1, 2, 3] }"), HasSubstr("holds 3 numbers"));
  EXPECT_THAT(error_of("{ normal = [1, -2] }"), HasSubstr("negative standard deviation"));
  EXPECT_THAT(error_of("{ log_uniform = [0, 1] }"), HasSubstr("not positive"));
  EXPECT_THAT(error_of("{ choice = [] }"), HasSubstr("nothing to choose from"));
  EXPECT_THROW(Distribution(Kind::uniform, {1.0}), InputError);
}

TEST(Distribution, MissingKeyIsNamedOrReplaced) {
  const SharedTable table = parse_toml("b = 1", "scenario.toml");
  TableReader reader(table, "scenario.toml");
  EXPECT_THAT(error_message([&] { read_distribution(reader, "a"); }), HasSubstr("a: is missing"));
  EXPECT_EQ(draws(read_distribution_or(reader, "a", 2.0))[0], 2.0);
}

}  // namespace
}  // namespace truebearing::distribution_test
