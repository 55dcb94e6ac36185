// SPDX-License-Identifier: Apache-2.0
// What the angular innovations of an interval cost, in the currency of the paper's table: additions, subtractions,
// multiplications and divisions of real numbers, for all N targets.
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>
#include <cstdio>
#include <string>

#include "truebearing/array/angular_innovation.hpp"
#include "truebearing/core/angle.hpp"
#include "truebearing/core/random.hpp"

namespace truebearing::operation_count_test {
namespace {

/// A double that counts what is done with it. Signs, comparisons and copies are free, a square root is one operation.
struct Counted {
  double value = 0.0;
  static inline long operations = 0;

  Counted() = default;
  Counted(double v) : value(v) {}  // NOLINT: as a double would

  Counted& operator+=(Counted b) { return *this = *this + b; }
  Counted& operator-=(Counted b) { return *this = *this - b; }
  Counted& operator*=(Counted b) { return *this = *this * b; }
  Counted& operator/=(Counted b) { return *this = *this / b; }
  Counted operator-() const { return -value; }
  friend Counted operator+(Counted a, Counted b) { return counted(a.value + b.value); }
  friend Counted operator-(Counted a, Counted b) { return counted(a.value - b.value); }
  friend Counted operator*(Counted a, Counted b) { return counted(a.value * b.value); }
  friend Counted operator/(Counted a, Counted b) { return counted(a.value / b.value); }
  friend Counted sqrt(Counted a) { return counted(std::sqrt(a.value)); }
  friend Counted abs(Counted a) { return std::abs(a.value); }
  friend auto operator<=>(Counted a, Counted b) = default;

 private:
  static Counted counted(double value) {
    ++operations;
    return value;
  }
};

}  // namespace
}  // namespace truebearing::operation_count_test

template <>
struct Eigen::NumTraits<truebearing::operation_count_test::Counted> : Eigen::NumTraits<double> {
  using Real = truebearing::operation_count_test::Counted;
  using NonInteger = truebearing::operation_count_test::Counted;
  using Nested = truebearing::operation_count_test::Counted;
  enum {
    IsComplex = 0,
    IsInteger = 0,
    IsSigned = 1,
    RequireInitialization = 1,
    ReadCost = 1,
    AddCost = 1,
    MulCost = 1
  };
};

namespace truebearing::operation_count_test {
namespace {

constexpr int kSensors = 15;
constexpr double kTolerance = 0.05;  // of a formula, which counts n additions for a sum of n

/// Operations of all N innovations from a basis of no structure.
template <typename Innovation>
long operations_of(int N) {
  RandomStream random({}, StreamId::test);
  SplitMatrix<Counted> W, a, b;
  for (SplitMatrix<Counted>* columns : {&W, &a, &b}) columns->setZero(kSensors, N);
  const LineArray array{kSensors, 0.5};
  for (int n = 0; n < N; ++n) {
    for (int m = 0; m < kSensors; ++m) {
      W.re(m, n) = random.normal();
      W.im(m, n) = random.normal();
    }
    array.steer(radians(-50.0 + 20.0 * n), n, a, b);
  }
  Innovation innovation;
  Counted::operations = 0;
  innovation.prepare(W);
  for (int n = 0; n < N; ++n) innovation(a, b, n);
  return Counted::operations;
}

// As many operations as the papers' formulas say, which count a product of (m x k) and (k x n) as 2 m k n and an
// inverse as 2 n^3.
long projection_formula(int M, int N) {
  const int gram = 8 * M * N * N, inverse = 2 * (2 * N) * (2 * N) * (2 * N), V = 8 * M * N * N, P = 8 * M * M * N;
  const int of_target = 2 * 8 * M * M + 2 * 4 * M;
  return gram + inverse + V + P + N * of_target;
}
long ryu_formula(int M, int N) {
  const int n = 2 * N + 1;
  const int normal = 2 * 2 * M * n * n, inverse = 2 * n * n * n, solver = 2 * 2 * M * n * n, solution = 2 * 2 * M * n;
  return N * (normal + inverse + solver + solution);
}

struct Row {
  int N;
  long projection, ryu, implicit, most_implicit;
  long printed_projection, printed_ryu;
};
constexpr Row kRows[] = {{5, 35600, 89210, 10816, 12000, 35895, 92482},
                         {6, 45216, 152724, 15444, 17000, 45101, 158138}};

TEST(OperationCount, FormulasGiveThePapersCounts) {
  for (const Row& row : kRows) {
    EXPECT_EQ(projection_formula(kSensors, row.N), row.projection);
    EXPECT_EQ(ryu_formula(kSensors, row.N), row.ryu);
    // The printed ones, which come from a measurement, are near.
    EXPECT_NEAR(static_cast<double>(row.projection), static_cast<double>(row.printed_projection), 0.05 * 35895);
    EXPECT_NEAR(static_cast<double>(row.ryu), static_cast<double>(row.printed_ryu), 0.05 * 158138);
  }
}

TEST(OperationCount, ImplementationsKeepToTheFormulas) {
  std::printf("operations of an interval, M = 15      N = 5     N = 6\n");
  const auto print = [](const char* name, long five, long six) { std::printf("%-33s %10ld%10ld\n", name, five, six); };
  const long projection[] = {operations_of<ProjectionInnovation<Counted>>(5),
                             operations_of<ProjectionInnovation<Counted>>(6)};
  const long ryu[] = {operations_of<RyuInnovation<Counted>>(5), operations_of<RyuInnovation<Counted>>(6)};
  const long implicit[] = {operations_of<ImplicitInnovation<Counted>>(5),
                           operations_of<ImplicitInnovation<Counted>>(6)};
  print("Ryu 1999, printed", kRows[0].printed_ryu, kRows[1].printed_ryu);
  print("Ryu 1999, formula", kRows[0].ryu, kRows[1].ryu);
  print("RyuInnovation", ryu[0], ryu[1]);
  print("Ryu 2001, printed", kRows[0].printed_projection, kRows[1].printed_projection);
  print("Ryu 2001, formula", kRows[0].projection, kRows[1].projection);
  print("ProjectionInnovation", projection[0], projection[1]);
  print("implicit form, counted by hand", kRows[0].implicit, kRows[1].implicit);
  print("ImplicitInnovation", implicit[0], implicit[1]);
  for (std::size_t i = 0; i < 2; ++i) {
    const Row& row = kRows[i];
    SCOPED_TRACE("N = " + std::to_string(row.N));
    const auto within = [](long formula) { return kTolerance * static_cast<double>(formula); };
    EXPECT_NEAR(static_cast<double>(projection[i]), static_cast<double>(row.projection), within(row.projection));
    EXPECT_NEAR(static_cast<double>(ryu[i]), static_cast<double>(row.ryu), within(row.ryu));
    EXPECT_LE(implicit[i], row.most_implicit);
  }
}

}  // namespace
}  // namespace truebearing::operation_count_test
