// SPDX-License-Identifier: Apache-2.0
#include "truebearing/filter/factorization.hpp"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "truebearing/core/constants.hpp"
#include "truebearing/core/linear_algebra.hpp"
#include "truebearing/core/random.hpp"

namespace truebearing::factorization_test {
namespace {

template <typename Size>
class SquareMatrices : public ::testing::Test {
 public:
  static constexpr int kSize = Size::value;
  using Square = Eigen::Matrix<double, kSize, kSize>;
  using Column = Eigen::Matrix<double, kSize, 1>;

  // A correlation matrix with eigenvalues from `least` up, its variances drawn over `decades` on both sides of `scale`.
  Square covariance(double least, double scale, double decades) {
    const Square A = Square::NullaryExpr([&] { return random.normal(); });
    Column eigenvalues = Column::NullaryExpr([&] { return random.uniform(0.5, 2.0); });
    eigenvalues[0] = least;
    const Square Q = symmetric_modes<Eigen::Dynamic>(A + A.transpose()).vectors;
    Square P = Q * eigenvalues.asDiagonal() * Q.transpose();
    for (int i = 0; i < kSize; ++i) {
      const double sigma = std::sqrt(scale) * std::pow(10.0, random.uniform(-decades, decades) / 2.0);
      P.row(i) *= sigma;
      P.col(i) *= sigma;
    }
    return (P + P.transpose()) / 2.0;
  }

  // Compiled once for each size: what is under test is written out wherever it stands.
  [[gnu::noinline]] static bool semidefinite(const Square& P) { return is_positive_semidefinite<kSize, double>(P); }
  [[gnu::noinline]] static Square lower_root(const Square& P) { return semidefinite_root<kSize, double>(P); }
  [[gnu::noinline]] static Square upper_root(const Square& P) { return upper_semidefinite_root<kSize, double>(P); }
  [[gnu::noinline]] static void triangular(Square& A, Square& B) { triangularize<kSize, kSize, double>(A, B); }

  RandomStream random{{.seed = kSize}, StreamId::test};
};

using Sizes =
    ::testing::Types<std::integral_constant<int, 1>, std::integral_constant<int, 2>, std::integral_constant<int, 3>,
                     std::integral_constant<int, 4>, std::integral_constant<int, 5>, std::integral_constant<int, 6>>;
TYPED_TEST_SUITE(SquareMatrices, Sizes);

// Products of variances leave the range of a double at both ends, and the answer stays.
TYPED_TEST(SquareMatrices, PositiveOnesAreFoundToBeAtAnyScale) {
  for (const double scale : {1e-290, 1e-150, 1e-30, 1.0, 1e30, 1e150, 1e290})
    for (int k = 0; k < 200; ++k) {
      const auto P = this->covariance(k % 2 ? 1e-6 : 0.5, scale, 8.0);
      EXPECT_TRUE(TestFixture::semidefinite(P)) << scale << "\n" << P;
    }
}

// Negative by far more than rounding makes it.
TYPED_TEST(SquareMatrices, IndefiniteOnesAreFoundToBeAtAnyScale) {
  for (const double scale : {1e-290, 1e-150, 1e-30, 1.0, 1e30, 1e150, 1e290})
    for (int k = 0; k < 200; ++k) {
      const auto P = this->covariance(k % 2 ? -1e-6 : -0.5, scale, 8.0);
      EXPECT_FALSE(TestFixture::semidefinite(P)) << scale << "\n" << P;
    }
}

// Of an even number of them the determinant is positive.
TYPED_TEST(SquareMatrices, OnesOfNegativeVariancesAreNot) {
  constexpr int N = TestFixture::kSize;
  for (int negative = 1; negative < 1 << N; ++negative) {
    auto P = this->covariance(0.5, 1.0, 2.0);
    for (int i = 0; i < N; ++i)
      if (negative >> i & 1) P(i, i) *= -1.0;
    EXPECT_FALSE(TestFixture::semidefinite(P)) << P;
  }
}

// Two variables that are one, and a third that is said to be correlated with them by more than 1: whatever is eliminated
// after the two is made of rounding.
TYPED_TEST(SquareMatrices, RoundingHasNoSayBehindTwoVariablesThatAreOne) {
  constexpr int N = TestFixture::kSize;
  if constexpr (N >= 3) {
    for (const double correlation : {1.01, 1.2, 100.0})
      for (int k = 0; k < 2000; ++k) {
        auto P = this->covariance(0.5, 1.0, 0.0);
        const double a = this->random.uniform(0.1, 10.0), b = this->random.uniform(0.1, 10.0);
        const double c = this->random.uniform(0.1, 10.0);
        P(0, 0) = a * a;
        P(1, 1) = b * b;
        P(0, 1) = P(1, 0) = a * b;
        P(2, 2) = c * c;
        P(0, 2) = P(2, 0) = correlation * a * c;
        P(1, 2) = P(2, 1) = correlation * b * c;
        ASSERT_FALSE(TestFixture::semidefinite(P)) << P;
      }
  }
}

TYPED_TEST(SquareMatrices, SingularOnesAreSemidefinite) {
  constexpr int N = TestFixture::kSize;
  using Matrix = typename TestFixture::Square;
  EXPECT_TRUE(TestFixture::semidefinite(Matrix::Zero()));
  EXPECT_TRUE(TestFixture::semidefinite(Matrix::Ones()));
  Matrix one = Matrix::Zero();
  one(N - 1, N - 1) = 1.0;
  EXPECT_TRUE(TestFixture::semidefinite(one));
}

TYPED_TEST(SquareMatrices, OnesThatAreNotFiniteAreNot) {
  constexpr int N = TestFixture::kSize;
  for (const double value : {kNaN, HUGE_VAL, -HUGE_VAL})
    for (int j = 0; j < N; ++j)
      for (int i = j; i < N; ++i) {
        auto P = this->covariance(0.5, 1.0, 2.0);
        P(i, j) = P(j, i) = value;
        EXPECT_FALSE(TestFixture::semidefinite(P)) << P;
      }
  typename TestFixture::Square infinite = TestFixture::Square::Identity();
  infinite.diagonal().setConstant(HUGE_VAL);
  EXPECT_FALSE(TestFixture::semidefinite(infinite));
}

TYPED_TEST(SquareMatrices, RootsAreTriangularAndSquareToTheMatrix) {
  constexpr int N = TestFixture::kSize;
  for (int k = 0; k < 200; ++k) {
    const auto P = this->covariance(1e-3, 1.0, 6.0);
    const auto L = TestFixture::lower_root(P);
    const auto U = TestFixture::upper_root(P);
    for (int j = 0; j < N; ++j)
      for (int i = 0; i < N; ++i) {
        const double size = std::sqrt(P(i, i) * P(j, j));
        EXPECT_NEAR((L * L.transpose())(i, j), P(i, j), 1e-13 * size);
        EXPECT_NEAR((U * U.transpose())(i, j), P(i, j), 1e-13 * size);
        if (i < j) {
          EXPECT_EQ(L(i, j), 0.0);
          EXPECT_EQ(U(j, i), 0.0);
        }
      }
  }
}

TYPED_TEST(SquareMatrices, RootsOfSingularOnesSquareToThemAndOfIndefiniteOnesAreNaN) {
  constexpr int N = TestFixture::kSize;
  using Matrix = typename TestFixture::Square;
  for (int k = 0; k < 200; ++k) {
    const auto a = TestFixture::Column::NullaryExpr([&] { return this->random.normal(); }).eval();
    const Matrix P = a * a.transpose();
    const auto L = TestFixture::lower_root(P);
    const auto U = TestFixture::upper_root(P);
    for (int j = 0; j < N; ++j)
      for (int i = 0; i < N; ++i) {
        EXPECT_NEAR((L * L.transpose())(i, j), P(i, j), 1e-13 * std::abs(P(i, j)));
        EXPECT_NEAR((U * U.transpose())(i, j), P(i, j), 1e-13 * std::abs(P(i, j)));
      }
    const auto indefinite = this->covariance(-1e-6, 1.0, 8.0);
    EXPECT_TRUE(TestFixture::lower_root(indefinite).diagonal().array().isNaN().all()) << indefinite;
    EXPECT_TRUE(TestFixture::upper_root(indefinite).diagonal().array().isNaN().all()) << indefinite;
  }
}

TYPED_TEST(SquareMatrices, TriangularizeKeepsTheProductAndWhatIsTriangular) {
  constexpr int N = TestFixture::kSize;
  using Matrix = typename TestFixture::Square;
  for (int k = 0; k < 200; ++k) {
    const auto coefficient = [&] { return this->random.uniform() < 0.3 ? 0.0 : this->random.normal(); };
    const Matrix A = Matrix::NullaryExpr(coefficient), B = Matrix::NullaryExpr(coefficient);
    Matrix zero = A, U = B;
    TestFixture::triangular(zero, U);
    EXPECT_LE((U * U.transpose() - A * A.transpose() - B * B.transpose()).norm(),
              1e-14 * (A.squaredNorm() + B.squaredNorm()));
    EXPECT_EQ(zero, Matrix::Zero());
    for (int j = 0; j < N; ++j)
      for (int i = j + 1; i < N; ++i) EXPECT_EQ(U(i, j), 0.0);
    const Matrix before = U;
    TestFixture::triangular(zero, U);
    EXPECT_EQ(U, before);
  }
}

}  // namespace
}  // namespace truebearing::factorization_test
