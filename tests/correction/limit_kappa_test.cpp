// SPDX-License-Identifier: Apache-2.0
#include "truebearing/correction/limit_kappa.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "tests/support/environment.hpp"
#include "tests/support/line_trackers.hpp"

#include "truebearing/core/constants.hpp"

namespace truebearing::limit_kappa_test {
namespace {

int hostile_cases(int otherwise) {
  return testing::number_from_environment("TRUEBEARING_KAPPA_CASES", otherwise);
}

BoundedMatrix random_covariance(RandomStream& random, Eigen::Index n, double decades) {
  const BoundedMatrix A = BoundedMatrix::NullaryExpr(n, n, [&] { return random.normal(); });
  const BoundedVector scale =
      BoundedVector::NullaryExpr(n, [&] { return std::pow(10.0, random.uniform(-decades, decades)); });
  return scale.asDiagonal() * (A * A.transpose() + 0.05 * BoundedMatrix::Identity(n, n)) * scale.asDiagonal();
}

#ifdef __SIZEOF_FLOAT128__
__extension__ using Exact = __float128;  // 113 binary digits: twice those of double
#else
using Exact = long double;
#endif

// Of x - x_reference under P, in other arithmetic and by another elimination than the code's; infinite where P is not
// positive definite.
double exact_distance(const BoundedMatrix& P, const BoundedVector& x, const BoundedVector& x_reference) {
  const Eigen::Index n = x.size();
  std::vector<std::vector<Exact>> W(static_cast<std::size_t>(n));
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index j = 0; j < n; ++j)
      W[static_cast<std::size_t>(i)].push_back(Exact(P(std::max(i, j), std::min(i, j))));
    W[static_cast<std::size_t>(i)].push_back(Exact(x[i]) - Exact(x_reference[i]));
  }
  Exact squared = 0;
  const auto size = static_cast<std::size_t>(n);
  for (std::size_t k = 0; k < size; ++k) {
    if (!(W[k][k] > 0)) return kInfinity;
    squared += W[k][size] * W[k][size] / W[k][k];
    for (std::size_t i = k + 1; i < size; ++i)
      for (std::size_t j = size + 1; j-- > k;) W[i][j] -= W[i][k] / W[k][k] * W[k][j];
  }
  return std::sqrt(static_cast<double>(squared));
}

TEST(LimitKappa, ShortCorrectionPassesUnchanged) {
  const BoundedMatrix P = BoundedVector(Eigen::Vector2d(100.0, 4.0)).asDiagonal();
  const BoundedVector d = Eigen::Vector2d(10.0, -2.0);
  const Limited limited = limit_kappa(P, d, 3.0);
  EXPECT_FALSE(limited.limited);
  EXPECT_EQ(limited.d, d);
  EXPECT_DOUBLE_EQ(limited.distance_sigmas, std::sqrt(2.0));
}

TEST(LimitKappa, LongCorrectionKeepsItsDirection) {
  const BoundedMatrix P = BoundedVector(Eigen::Vector2d(100.0, 4.0)).asDiagonal();
  const Limited limited = limit_kappa(P, BoundedVector(Eigen::Vector2d(300.0, -80.0)), 3.0);  // 50 standard deviations
  EXPECT_TRUE(limited.limited);
  EXPECT_NEAR(limited.d[0], 18.0, 1e-12);
  EXPECT_NEAR(limited.d[1], -4.8, 1e-12);
  EXPECT_EQ(limited.distance_sigmas, 3.0);
}

TEST(LimitKappa, InfiniteKappaLeavesAFiniteCorrectionAlone) {
  const BoundedMatrix indefinite = -BoundedMatrix::Identity(2, 2);
  const BoundedVector d = Eigen::Vector2d(1e300, -1.0);
  EXPECT_EQ(limit_kappa(indefinite, d, kInfinity).d, d);
  EXPECT_TRUE(limit_kappa(indefinite, BoundedVector(Eigen::Vector2d(kNaN, 1.0)), kInfinity).d.isZero(0.0));
}

TEST(LimitKappa, CovarianceThatIsNoneAllowsNothing) {
  for (const double variance : {-1.0, 0.0, kNaN}) {
    const BoundedMatrix P = BoundedVector(Eigen::Vector2d(1.0, variance)).asDiagonal();
    const Limited limited = limit_kappa(P, BoundedVector(Eigen::Vector2d(1.0, 1.0)), 3.0);
    EXPECT_TRUE(limited.d.isZero(0.0)) << variance;
    EXPECT_TRUE(limited.limited);
    EXPECT_EQ(limited.distance_sigmas, 0.0);
  }
}

// Whatever goes in: what comes out is finite and at most kappa standard deviations long.
TEST(LimitKappa, NothingPassesTheBound) {
  RandomStream random({.seed = 21}, StreamId::test);
  const std::array<double, 12> hostile{kNaN,  kInfinity, -kInfinity, 1.7e308, -1e308, 1e200,
                                       1e154, 1e-154,    1e-308,     5e-324,  0.0,    -1e-200};
  const int cases = hostile_cases(100000);
  int limited_cases = 0, moved = 0;
  for (int k = 0; k < cases; ++k) {
    const auto n = static_cast<Eigen::Index>(1 + random.index(kMaxDimension));
    const double kappa = std::pow(10.0, random.uniform(-3.0, 3.0));
    BoundedMatrix P = random_covariance(random, n, k % 2 == 0 ? 1.0 : 8.0);
    BoundedVector d = BoundedVector::NullaryExpr(n, [&] { return random.normal(); });
    d *= std::pow(10.0, random.uniform(-3.0, 6.0));
    const bool tame = k % 4 == 0;
    if (!tame) {
      const double kind = random.uniform();
      if (kind < 0.4)
        d[static_cast<Eigen::Index>(random.index(static_cast<std::uint64_t>(n)))] = hostile[random.index(12)];
      if (kind > 0.3 && kind < 0.5) d *= hostile[3 + random.index(9)];
      if (kind > 0.5 && kind < 0.6) P(n - 1, n - 1) *= -1.0;                           // indefinite
      if (kind > 0.6 && kind < 0.7) P.row(0) = P.row(n - 1), P.col(0) = P.col(n - 1);  // singular, up to rounding
      if (kind > 0.7 && kind < 0.8) P *= hostile[3 + random.index(9)];
      if (kind > 0.8 && kind < 0.85) P(0, n - 1) = P(n - 1, 0) = hostile[random.index(12)];
      if (kind > 0.85 && kind < 0.9) P(n - 1, 0) += 1.0;  // asymmetric
    }
    const Limited limited = limit_kappa(P, d, kappa);
    ASSERT_EQ(limited.d.size(), n);
    ASSERT_TRUE(limited.d.allFinite()) << k << "\n" << P << "\n" << d;
    ASSERT_LE(limited.distance_sigmas, kappa * (1.0 + 1e-9)) << k;
    if (!limited.d.isZero(0.0)) {
      ASSERT_LE(exact_distance(P, limited.d, BoundedVector::Zero(n)), kappa * (1.0 + 1e-9)) << k << "\n" << P;
      moved += tame ? 0 : 1;
    }
    limited_cases += limited.limited ? 1 : 0;
  }
  EXPECT_GT(limited_cases, 0.2 * cases);
  EXPECT_LT(limited_cases, 0.95 * cases) << "the bound must not be kept by allowing nothing";
  EXPECT_GT(moved, 0.3 * cases) << "three in four are hostile";
}

// Whatever the units of the components: the elimination does not scale them first.
TEST(SafeDistance, IsExactToOneInABillionInAnyUnits) {
  RandomStream random({.seed = 23}, StreamId::test);
  int known = 0;
  for (int k = 0; k < 2000; ++k) {
    const auto n = static_cast<Eigen::Index>(1 + random.index(6));
    const BoundedMatrix P = random_covariance(random, n, k % 2 == 0 ? 2.0 : 140.0);
    BoundedVector d(n);
    for (Eigen::Index i = 0; i < n; ++i) d[i] = std::sqrt(P(i, i)) * random.normal();
    const double distance = SafeDistance(P).of(d), exact = exact_distance(P, d, BoundedVector::Zero(n));
    if (std::isinf(distance)) continue;
    ++known;
    EXPECT_NEAR(distance, exact, 1e-9 * exact) << k << "\n" << P;
  }
  EXPECT_GT(known, 1900);
}

// References of filters that were told tiny standard deviations: ill-conditioned, singular, and far below the last
// digit of the estimate that they belong to. What is published is bounded in exact arithmetic, or it is the reference.
TEST(WithinKappa, NothingThatIsPublishedPassesTheBound) {
  RandomStream random({.seed = 22}, StreamId::test);
  const int cases = hostile_cases(1000000);
  int moved = 0, not_definite = 0;
  for (int k = 0; k < cases; ++k) {
    const auto n = static_cast<Eigen::Index>(2 + random.index(3));
    const double kappa = std::pow(10.0, random.uniform(-2.0, 2.0));
    BoundedVector sigma(n), x_reference(n), d(n);
    for (Eigen::Index i = 0; i < n; ++i) {
      sigma[i] = std::pow(10.0, random.uniform(-19.0, 4.0));
      x_reference[i] = std::pow(10.0, random.uniform(-2.0, 5.0)) * random.normal();
      d[i] = std::pow(10.0, random.uniform(-20.0, 5.0)) * random.normal();
    }
    // One line of sight is known far better than the other, and lies askew.
    const BoundedMatrix turn = BoundedMatrix::NullaryExpr(n, n, [&] { return random.normal(); });
    const BoundedMatrix P = turn * sigma.cwiseAbs2().asDiagonal() * turn.transpose();
    const Limited limited = limit_kappa(P, d, kappa);
    const BoundedVector x = within_kappa(x_reference, P, BoundedVector(random.uniform() * limited.d), kappa);
    if (x == x_reference) continue;
    ++moved;
    const double distance = exact_distance(P, x, x_reference);
    not_definite += std::isinf(distance);
    ASSERT_LE(distance, kappa * (1.0 + 1e-9)) << k << "\n" << P << "\n" << d;
  }
  EXPECT_EQ(not_definite, 0);
  EXPECT_GT(moved, 0.1 * cases) << "the bound must not be kept by allowing nothing";
}

}  // namespace
}  // namespace truebearing::limit_kappa_test
