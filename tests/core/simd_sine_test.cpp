// SPDX-License-Identifier: Apache-2.0
#include "truebearing/core/simd_sine.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "truebearing/core/random.hpp"

namespace truebearing::simd_sine_test {
namespace {

template <int kWidth>
void expect_those_of_the_library(double largest, double tolerance) {
  RandomStream random({1, Role::evaluation, 0}, StreamId::test);
  for (int trial = 0; trial < 20000; ++trial) {
    constexpr std::size_t kCount = kWidth;
    double x[kCount], sine[kCount], cosine[kCount];
    for (double& each : x) each = random.uniform(-largest, largest);
    using Vector = VectorOf<kWidth>;
    typename Vector::Doubles of, sines, cosines;
    Vector::load(x, of);
    sine_and_cosine<kWidth>(of, sines, cosines);
    Vector::store(sines, sine);
    Vector::store(cosines, cosine);
    for (std::size_t i = 0; i < kCount; ++i) {
      ASSERT_NEAR(sine[i], std::sin(x[i]), tolerance) << x[i];
      ASSERT_NEAR(cosine[i], std::cos(x[i]), tolerance) << x[i];
    }
  }
}

TEST(SimdSine, IsThatOfTheLibraryInFourLanesAndInEight) {
  for (const double largest : {1e-3, 2.0, 30.0, 1e4, 1e8}) {
    expect_those_of_the_library<4>(largest, 3e-16);
    expect_those_of_the_library<8>(largest, 3e-16);
  }
}

TEST(SimdSine, OfWhatIsNotFiniteIsNone) {
  using Vector = VectorOf<4>;
  Vector::Doubles x{std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN(), 0.0, 1.0}, s, c;
  sine_and_cosine<4>(x, s, c);
  EXPECT_TRUE(std::isnan(s[0]) && std::isnan(c[0]));
  EXPECT_TRUE(std::isnan(s[1]) && std::isnan(c[1]));
  EXPECT_EQ(s[2], 0.0);
  EXPECT_EQ(c[2], 1.0);
}

}  // namespace
}  // namespace truebearing::simd_sine_test
