// SPDX-License-Identifier: Apache-2.0
#include "truebearing/core/simd_exponential.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "truebearing/core/random.hpp"

namespace truebearing::simd_exponential_test {
namespace {

template <int kWidth>
void expect_that_of_the_library(double least) {
  RandomStream random({1, Role::evaluation, 0}, StreamId::test);
  using Vector = VectorOf<kWidth>;
  constexpr std::size_t kCount = kWidth;
  for (int trial = 0; trial < 5000; ++trial) {
    double x[kCount], powers[kCount];
    for (double& each : x) each = random.uniform(least, 0.0);
    x[0] = trial == 0 ? 0.0 : trial == 1 ? least : x[0];
    typename Vector::Doubles of;
    Vector::load(x, of);
    exponential<kWidth>(of);
    Vector::store(of, powers);
    for (std::size_t i = 0; i < kCount; ++i) ASSERT_NEAR(powers[i], std::exp(x[i]), 4.5e-16 * std::exp(x[i])) << x[i];
  }
}

TEST(SimdExponential, IsThatOfTheLibraryInFourLanesAndInEight) {
  for (const double least : {-708.0, -30.0, -1.0, -1e-6}) {
    expect_that_of_the_library<4>(least);
    expect_that_of_the_library<8>(least);
  }
}

}  // namespace
}  // namespace truebearing::simd_exponential_test
