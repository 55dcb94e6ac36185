// SPDX-License-Identifier: Apache-2.0
#include "truebearing/evaluation/step_columns.hpp"

#include <cmath>
#include <cstring>
#include <gtest/gtest.h>
#include <numeric>

#include "truebearing/core/constants.hpp"
#include "truebearing/core/random.hpp"

namespace truebearing::step_columns_test {
namespace {

// d' P^-1 d of one step by elimination; P: its lower triangle, row by row.
double squared_by_P(std::vector<double> d, std::vector<std::vector<double>> P) {
  double sum = 0.0;
  for (std::size_t k = 0; k < d.size(); ++k) {
    if (!(P[k][k] > 0.0)) return kNaN;
    const double inverse = 1.0 / P[k][k];
    sum += d[k] * d[k] * inverse;
    for (std::size_t i = k + 1; i < d.size(); ++i) {
      const double factor = P[i][k] * inverse;
      d[i] -= factor * d[k];
      for (std::size_t j = k + 1; j <= i; ++j) P[i][j] -= factor * P[j][k];
    }
  }
  return sum;
}

double norm(const std::vector<double>& d) {
  double squares = 0.0;
  for (const double value : d) squares += value * value;
  return std::sqrt(squares);
}

void expect_same(double found, double wanted, const char* what, int lane) {
  if (std::isnan(wanted))
    EXPECT_TRUE(std::isnan(found)) << what << " of lane " << lane << " is " << found;
  else
    EXPECT_EQ(found, wanted) << what << " of lane " << lane;
}

// The distances in the components at `places` against those of each lane by itself.
void expect_distances(const StepColumns& columns, const std::vector<int>& places) {
  StepDistances found;
  kernels::distances(columns, places.data(), static_cast<int>(places.size()), found);
  for (int lane = 0; lane < StepColumns::kSteps; ++lane) {
    std::vector<double> d;
    std::vector<std::vector<double>> P;
    for (const int i : places) {
      d.push_back(columns.d(i)[lane]);
      P.emplace_back();
      for (std::size_t k = 0; k < d.size(); ++k)
        P.back().push_back(columns.P(std::max(i, places[k]), std::min(i, places[k]))[lane]);
    }
    const auto at = static_cast<std::size_t>(lane);
    expect_same(found.norm[at], norm(d), "norm", lane);
    expect_same(found.squared_by_P[at], squared_by_P(d, P), "squared_by_P", lane);
  }
}

// Differences of n components, and covariances A A' + 1/10.
StepColumns random_columns(int n) {
  RandomStream random({.seed = 5, .run = static_cast<std::uint64_t>(n)}, StreamId::test);
  StepColumns columns(n);
  for (int lane = 0; lane < StepColumns::kSteps; ++lane) {
    std::vector<double> A(static_cast<std::size_t>(n * n));
    for (double& a : A) a = random.normal();
    for (int i = 0; i < n; ++i) {
      columns.d(i)[lane] = 3.0 * random.normal();
      for (int j = 0; j <= i; ++j)
        columns.P(i, j)[lane] =
            std::inner_product(&A[static_cast<std::size_t>(i * n)], &A[static_cast<std::size_t>(i * n)] + n,
                               &A[static_cast<std::size_t>(j * n)], i == j ? 0.1 : 0.0);
    }
  }
  return columns;
}

TEST(StepColumns, DistancesOfLanesAreThoseOfEachStepToTheBit) {
  for (int n = 1; n <= 10; ++n) {
    const StepColumns columns = random_columns(n);
    std::vector<int> all(static_cast<std::size_t>(n));
    std::iota(all.begin(), all.end(), 0);
    expect_distances(columns, all);
    expect_distances(columns, {n - 1});
    expect_distances(columns, {all.rbegin(), all.rend()});
  }
}

TEST(StepColumns, WhatIsNoCovarianceHasNoDistanceByIt) {
  for (const double pivot : {0.0, -0.0, -1.0, kNaN, -kInfinity, kInfinity}) {
    StepColumns columns = random_columns(4);
    columns.P(0, 0)[1] = columns.P(2, 2)[3] = columns.P(3, 3)[6] = pivot;
    columns.P(1, 0)[5] = columns.d(3)[7] = kNaN;
    expect_distances(columns, {0, 1, 2, 3});
    expect_distances(columns, {2, 3});
    StepDistances found;
    kernels::distances(columns, std::vector<int>{0}.data(), 1, found);
    EXPECT_EQ(std::isnan(found.squared_by_P[1]), !(pivot > 0.0)) << pivot;
    EXPECT_FALSE(std::isnan(found.norm[1]));
    EXPECT_FALSE(std::isnan(found.squared_by_P[2]));
  }
}

}  // namespace
}  // namespace truebearing::step_columns_test
