// SPDX-License-Identifier: Apache-2.0
#include "truebearing/evaluation/statistics.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "truebearing/core/constants.hpp"
#include "truebearing/core/random.hpp"

namespace truebearing::statistics_test {
namespace {

std::vector<SquaredErrors> one_error_each(const std::vector<double>& errors) {
  std::vector<SquaredErrors> runs;
  for (const double error : errors) runs.emplace_back().add(error);
  return runs;
}

std::vector<double> without(std::vector<double> values, std::size_t i) {
  values.erase(values.begin() + static_cast<std::ptrdiff_t>(i));
  return values;
}

// The jackknife written out: sqrt((n - 1) / n sum (f_(i) - mean f)^2).
template <typename Figure>
double jackknife(const std::vector<double>& values, const Figure& figure) {
  const double n = static_cast<double>(values.size());
  std::vector<double> left_out;
  double mean = 0.0, squares = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) left_out.push_back(figure(without(values, i)));
  for (const double value : left_out) mean += value / n;
  for (const double value : left_out) squares += (value - mean) * (value - mean);
  return std::sqrt((n - 1.0) / n * squares);
}

std::vector<double> random_values(std::size_t count) {
  RandomStream random({}, StreamId::test);
  std::vector<double> values;
  for (std::size_t i = 0; i < count; ++i) values.push_back(3.0 + 2.0 * random.normal());
  return values;
}

TEST(Statistics, FiguresByHand) {
  EXPECT_DOUBLE_EQ(pooled_rmse(one_error_each({3.0, 4.0})).value, std::sqrt(12.5));
  EXPECT_DOUBLE_EQ(mean_of({1.0, 2.0, 6.0}).value, 3.0);
  EXPECT_DOUBLE_EQ(mean_of({1.0, 2.0, 6.0}).se, std::sqrt(14.0 / 2.0 / 3.0));
  EXPECT_DOUBLE_EQ(standard_deviation_of({1.0, 2.0, 6.0}).value, std::sqrt(7.0));
  EXPECT_DOUBLE_EQ(median_of({9.0, 1.0, 2.0}), 2.0);
  EXPECT_DOUBLE_EQ(median_of({9.0, 1.0, 2.0, 4.0}), 3.0);
}

void expect_places(const std::vector<double>& values, const std::string& what) {
  std::vector<double> ascending = values;
  std::sort(ascending.begin(), ascending.end());
  const std::size_t last = values.size() - 1;
  for (const std::size_t place : {std::size_t{0}, last / 10, last / 2, last - 1}) {
    EXPECT_EQ(middle_of(values, place, place), ascending[place]) << what << ", place " << place;
    EXPECT_EQ(middle_of(values, place, place + 1), 0.5 * (ascending[place + 1] + ascending[place])) << what;
  }
  EXPECT_EQ(middle_of(values, last, last), ascending[last]) << what;
  EXPECT_EQ(median_of(values), 0.5 * (ascending[values.size() / 2] + ascending[last / 2])) << what;
}

// So many that a sample tells where to look, and one less.
TEST(Statistics, PlacesOfManyAreThoseOfTheirOrder) {
  constexpr std::size_t kSample = 4096;
  for (const std::size_t count : {16 * kSample - 1, 16 * kSample, 20 * kSample + 17}) {
    std::vector<double> values = random_values(count);
    expect_places(values, "any order");
    std::vector<double> misleading = values;
    for (std::size_t i = 0; i < kSample; ++i) misleading[i * (count / kSample)] = 100.0;
    expect_places(misleading, "a sample that is beside the middle");
    for (double& value : values) value = std::round(2.0 * value);
    expect_places(values, "many equal ones");
    values[0] = values[7] = kInfinity;
    std::sort(values.begin(), values.end());
    expect_places(values, "in order");
  }
}

TEST(Statistics, StandardErrorsAreTheJackknife) {
  const std::vector<double> values = random_values(30);
  const auto rmse = [](const std::vector<double>& v) { return pooled_rmse(one_error_each(v)).value; };
  const auto deviation = [](const std::vector<double>& v) { return standard_deviation_of(v).value; };
  EXPECT_NEAR(pooled_rmse(one_error_each(values)).se, jackknife(values, rmse), 1e-12);
  EXPECT_NEAR(standard_deviation_of(values).se, jackknife(values, deviation), 1e-12);
}

TEST(Statistics, RunThatDivergedByManyOrdersLeavesTheOthersAlone) {
  std::vector<double> values = random_values(30);
  const double others = pooled_rmse(one_error_each(values)).value;
  values.insert(values.begin() + 7, 1e14);
  const Estimate rmse = pooled_rmse(one_error_each(values));
  EXPECT_NEAR(rmse.value, 1e14 / std::sqrt(31.0), 1.0);
  // Of the 31 left-out figures one is `others`, the rest 1e14 / sqrt(30).
  const double rest = 1e14 / std::sqrt(30.0);
  EXPECT_NEAR(rmse.se / ((30.0 / 31.0) * (rest - others)), 1.0, 1e-12);
}

TEST(Statistics, OfTooFewIsNaN) {
  EXPECT_TRUE(std::isnan(pooled_rmse({}).value));
  EXPECT_TRUE(std::isnan(pooled_rmse(one_error_each({1.0})).se));
  EXPECT_TRUE(std::isnan(mean_of({}).value));
  EXPECT_TRUE(std::isnan(mean_of({1.0}).se));
  EXPECT_TRUE(std::isnan(standard_deviation_of({1.0}).value));
  EXPECT_TRUE(std::isnan(standard_deviation_of({1.0, 2.0}).se));
  EXPECT_TRUE(std::isnan(median_of({})));
}

}  // namespace
}  // namespace truebearing::statistics_test
