// SPDX-License-Identifier: Apache-2.0
#include "truebearing/core/simd_logarithm.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "truebearing/core/random.hpp"

namespace truebearing::simd_logarithm_test {
namespace {

template <int kWidth>
void expect_that_of_the_library(double smallest, double largest) {
  RandomStream random({1, Role::evaluation, 0}, StreamId::test);
  using Vector = VectorOf<kWidth>;
  for (int trial = 0; trial < 5000; ++trial) {
    constexpr std::size_t kCount = kWidth;
    double x[kCount], logarithms[kCount];
    for (double& each : x) each = std::exp(random.uniform(std::log(smallest), std::log(largest)));
    x[0] = trial == 0 ? 1.0 : trial == 1 ? smallest : trial == 2 ? largest : x[0];
    typename Vector::Doubles of;
    Vector::load(x, of);
    logarithm<kWidth>(of);
    Vector::store(of, logarithms);
    for (std::size_t i = 0; i < kCount; ++i)
      ASSERT_NEAR(logarithms[i], std::log(x[i]), 2.3e-16 * std::abs(std::log(x[i]))) << x[i];
  }
}

TEST(SimdLogarithm, IsThatOfTheLibraryInFourLanesAndInEight) {
  const double least = std::numeric_limits<double>::min(), most = std::numeric_limits<double>::max();
  expect_that_of_the_library<4>(least, most);
  expect_that_of_the_library<8>(least, most);
  expect_that_of_the_library<8>(0.5, 2.0);
  expect_that_of_the_library<8>(1.0 - 1e-9, 1.0 + 1e-9);
}

}  // namespace
}  // namespace truebearing::simd_logarithm_test
