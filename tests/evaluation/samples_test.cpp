// SPDX-License-Identifier: Apache-2.0
#include "truebearing/evaluation/samples.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "truebearing/core/random.hpp"

namespace truebearing::samples_test {
namespace {

std::vector<double> normals(std::size_t count) {
  RandomStream random({.seed = 3}, StreamId::test);
  std::vector<double> values(count);
  for (double& value : values) value = 5.0 + 2.0 * random.normal();
  return values;
}

Samples of(const std::vector<double>& values) {
  Samples samples;
  for (const double value : values) samples.add(value);
  return samples;
}

void expect_near(const Estimate& figure, const Estimate& exact, double relative) {
  EXPECT_NEAR(figure.value, exact.value, relative * std::abs(exact.value));
  EXPECT_NEAR(figure.se, exact.se, relative * exact.se);
}

TEST(Samples, FewAreExact) {
  const std::vector<double> values = normals(kMostRunsApart);
  const Samples samples = of(values);
  EXPECT_EQ(samples.mean().value, mean_of(values).value);
  EXPECT_EQ(samples.mean().se, mean_of(values).se);
  EXPECT_EQ(samples.rmse().se, rmse_of(values).se);
  EXPECT_EQ(samples.standard_deviation().se, standard_deviation_of(values).se);
}

// Second-order terms of the jackknife are of the size 1 / n.
TEST(Samples, ManyAreAsGood) {
  const std::vector<double> values = normals(3 * kMostRunsApart);
  const Samples samples = of(values);
  expect_near(samples.mean(), mean_of(values), 1e-9);
  expect_near(samples.rmse(), rmse_of(values), 1e-4);
  expect_near(samples.standard_deviation(), standard_deviation_of(values), 1e-4);
}

TEST(RunErrors, FewAreExactAndManyAreTakenInGroups) {
  const std::vector<double> values = normals(2 * kMostRunsApart + 7);
  std::vector<SquaredErrors> runs;
  RunErrors errors;
  for (const double value : values) {
    runs.push_back({value * value, 2.0});
    errors.add(runs.back());
    errors.add({});
    if (runs.size() != kMostRunsApart) continue;
    EXPECT_EQ(errors.rmse().value, pooled_rmse(runs).value);
    EXPECT_EQ(errors.rmse().se, pooled_rmse(runs).se) << "runs without errors are passed over";
  }
  // The standard error from half as many groups has a spread of 1 / sqrt(2 n) itself; this is five of them.
  EXPECT_NEAR(errors.rmse().value, pooled_rmse(runs).value, 1e-12 * errors.rmse().value);
  EXPECT_NEAR(errors.rmse().se, pooled_rmse(runs).se,
              5.0 / std::sqrt(static_cast<double>(kMostRunsApart)) * pooled_rmse(runs).se);
}

TEST(MedianOf, IsExactOfFewAndWithinABinOfMany) {
  std::vector<double> values = normals(100000);
  for (double& value : values) value = std::abs(value);
  MedianOf apart(values.size()), binned(1000), none;
  for (const double value : values) {
    apart.add(value);
    binned.add(value);
  }
  EXPECT_EQ(apart.value(), median_of(values));
  EXPECT_NEAR(binned.value(), median_of(values), median_of(values) / 4096.0);
  EXPECT_TRUE(std::isnan(none.value()));
}

TEST(MedianOf, IsExactOfManyWhereTheMiddleStaysAmongThoseThatAreKept) {
  for (const std::size_t count : {9999u, 10000u, 40000u, 40001u}) {
    std::vector<double> values = normals(count);
    for (double& value : values) value = std::round(1e3 * std::abs(value));  // many are equal
    MedianOf narrowed(5000);
    for (const double value : values) narrowed.add(value);
    EXPECT_EQ(narrowed.value(), median_of(values)) << count;
  }
}

TEST(MedianOf, IsWithinABinWhereTheMiddleWandersAway) {
  MedianOf narrowed(1000);
  std::vector<double> values;
  for (int k = 0; k < 20000; ++k) {
    values.push_back(100.0 + k);
    narrowed.add(values.back());
  }
  EXPECT_NEAR(narrowed.value(), median_of(values), median_of(values) / 4096.0);
}

// As a block of runs has it, whose errors were more than are kept one by one.
TEST(MedianOf, GivesABlockAllThatItHasTaken) {
  std::vector<double> values = normals(10000);
  for (double& value : values) value = std::abs(value);
  std::vector<double> with_others = values;
  with_others.resize(values.size() + 3000, 1e6);
  const double median = median_of(with_others);
  for (const std::size_t kept_apart : {1000u, 20000u}) {
    for (const bool compact : {false, true}) {
      MedianOf block(kept_apart), all;
      for (int k = 0; k < 3000; ++k) all.add(1e6);
      for (const double value : values) block.add(value);
      TallyStream written(compact);
      block.exchange(written);
      TallyStream read(written.written());
      all.exchange(read);
      read.finish();
      EXPECT_NEAR(all.value(), median, median / 4096.0) << kept_apart << " kept apart, compact " << compact;
    }
  }
}

TEST(MedianOf, TakesAnyValueInABin) {
  MedianOf binned(0);
  for (const double value : {0.0, 1e-300, 1e300, 7.0, 7.0, 7.0, HUGE_VAL}) binned.add(value);
  EXPECT_NEAR(binned.value(), 7.0, 7.0 / 4096.0);
}

TEST(Share, IsThatOfZerosAndOnes) {
  Share share;
  EXPECT_TRUE(share.empty());
  EXPECT_TRUE(std::isnan(share.share().value));
  for (const bool is : {true, false, false, true, true}) share.add(is);
  const Estimate exact = share_of({1.0, 0.0, 0.0, 1.0, 1.0});
  EXPECT_EQ(share.share().value, exact.value);
  EXPECT_EQ(share.share().se, exact.se);
}

// By the prior's own integrals: Beta(k + 1/2, n - k + 1/2) on a fine grid.
TEST(Share, HasTheStandardErrorOfJeffreys) {
  for (const auto& [ones, count] : {std::pair(0.0, 20.0), std::pair(3.0, 20.0), std::pair(20.0, 20.0)}) {
    double mass = 0.0, first = 0.0, second = 0.0;
    constexpr int kCells = 20000;
    for (int i = 0; i < kCells; ++i) {
      const double angle = std::numbers::pi / 2.0 * (i + 0.5) / kCells, p = std::sin(angle) * std::sin(angle);
      const double weight = std::pow(p, ones) * std::pow(1.0 - p, count - ones);  // dp / sqrt(p (1 - p)) = 2 dangle
      mass += weight;
      first += weight * p;
      second += weight * p * p;
    }
    const double mean = first / mass;
    EXPECT_NEAR(share_of(ones, count).se, std::sqrt(second / mass - mean * mean), 1e-9) << ones;
  }
  EXPECT_NEAR(share_of(100.0, 1000.0).se, std::sqrt(0.1 * 0.9 / 1000.0), 2e-5) << "as that of a binomial";
}

}  // namespace
}  // namespace truebearing::samples_test
