// SPDX-License-Identifier: Apache-2.0
#include "truebearing/report/axis.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "truebearing/report/markup.hpp"

namespace truebearing::axis_test {
namespace {

using ::testing::DoubleNear;
using ::testing::ElementsAre;
using ::testing::Pointwise;

TEST(Axis, LinearTicksAreRoundAndHoldTheRange) {
  const Axis axis = linear_axis(3.0, 97.0, 5);
  EXPECT_THAT(axis.ticks, ElementsAre(0.0, 20.0, 40.0, 60.0, 80.0, 100.0));
  EXPECT_THAT(axis.labels, ElementsAre("0", "20", "40", "60", "80", "100"));
  EXPECT_EQ(axis.low, 0.0);
  EXPECT_EQ(axis.high, 100.0);
  EXPECT_EQ(axis.place(25.0), 0.25);
}

TEST(Axis, NeighbouringTicksReadDifferently) {
  for (const auto& [low, high] : {std::pair{0.0, 1e-7}, {9995.0, 10005.0}, {-0.31, 0.29}, {-5e12, 5e12}}) {
    const Axis axis = linear_axis(low, high, 5);
    ASSERT_GE(axis.ticks.size(), 3u) << low;
    ASSERT_LE(axis.ticks.size(), 12u) << low;
    for (std::size_t i = 1; i < axis.labels.size(); ++i) EXPECT_NE(axis.labels[i - 1], axis.labels[i]) << low;
    EXPECT_LE(axis.low, low);
    EXPECT_GE(axis.high, high);
  }
}

TEST(Axis, ExactRangeIsKept) {
  const Axis axis = exact_axis(3.0, 97.0, 5);
  EXPECT_EQ(axis.low, 3.0);
  EXPECT_THAT(axis.ticks, ElementsAre(20.0, 40.0, 60.0, 80.0));
}

TEST(Axis, RangeOfNothingIsWidened) {
  const Axis axis = linear_axis(4.0, 4.0, 5);
  EXPECT_LT(axis.low, 4.0);
  EXPECT_GT(axis.high, 4.0);
  EXPECT_GT(linear_axis(0.0, 0.0, 5).high, 0.0);
  EXPECT_GT(logarithmic_axis(4.0, 4.0).place(4.0), 0.0);
}

TEST(Axis, LogarithmicTicksArePowersOfTen) {
  EXPECT_THAT(logarithmic_axis(0.5, 2000.0).ticks, Pointwise(DoubleNear(1e-9), {1.0, 10.0, 100.0, 1000.0}));
  EXPECT_THAT(logarithmic_axis(3.0, 90.0).ticks, Pointwise(DoubleNear(1e-9), {5.0, 10.0, 20.0, 50.0}));
  EXPECT_LE(logarithmic_axis(1e-20, 1e20).ticks.size(), 8u);
  EXPECT_GE(logarithmic_axis(1.1, 1.3).ticks.size(), 2u);
  EXPECT_NEAR(logarithmic_axis(1.0, 100.0).place(10.0), 0.5, 1e-12);
  EXPECT_TRUE(std::isnan(logarithmic_axis(1.0, 100.0).place(0.0)));
}

TEST(Axis, OnlyPositiveValuesFarApartWantALogarithm) {
  EXPECT_TRUE(wants_logarithm({1.0, std::nan(""), 31.0}));
  EXPECT_FALSE(wants_logarithm({1.0, 29.0}));
  EXPECT_FALSE(wants_logarithm({0.0, 1.0, 1000.0}));
  EXPECT_FALSE(wants_logarithm({}));
}

TEST(Shown, FiguresAreShort) {
  EXPECT_EQ(shown(1338.21), "1338");
  EXPECT_EQ(shown(0.95, 3), "0.95");
  EXPECT_EQ(shown(-12.345, 3), "−12.3");
  EXPECT_EQ(shown(9.9999, 3), "10");
  EXPECT_EQ(shown(123456.0, 6), "123\u202f456");
  EXPECT_EQ(shown(0.0), "0");
  EXPECT_EQ(shown(1e-7, 1), "1e-7");
  EXPECT_EQ(shown(2.5e12, 2), "2.5e12");
  EXPECT_EQ(shown(std::nan("")), "-");
}

}  // namespace
}  // namespace truebearing::axis_test
