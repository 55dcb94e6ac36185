// SPDX-License-Identifier: Apache-2.0
#include "truebearing/tma/outliers.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "truebearing/core/random.hpp"

namespace truebearing::outliers_test {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

std::vector<double> noise(std::size_t count, std::uint64_t run) {
  RandomStream stream({1, Role::evaluation, run}, StreamId::test);
  std::vector<double> residuals;
  for (std::size_t i = 0; i < count; ++i) residuals.push_back(stream.normal());
  return residuals;
}

std::vector<std::size_t> found(std::span<const double> residuals) {
  OutlierSearch search;
  return places(search(residuals));
}

TEST(Outliers, AreFoundWhereverTheyStand) {
  for (const std::size_t at : {0u, 1u, 20u, 98u, 99u}) {
    std::vector<double> residuals = noise(100, at);
    residuals[at] += 10.0;
    EXPECT_THAT(found(residuals), ElementsAre(at));
  }
}

TEST(Outliers, OfGoodResidualsAreRare) {
  int lists = 0;
  for (std::uint64_t run = 0; run < 2000; ++run) lists += !found(noise(60, run)).empty();
  EXPECT_LT(lists, 12);  // two are expected; twelve come once in a million
}

TEST(Outliers, AreNoneOfASlowMisfit) {
  std::vector<double> residuals = noise(200, 1);
  for (std::size_t i = 0; i < 200; ++i) residuals[i] += 30.0 * std::sin(0.03 * static_cast<double>(i));
  EXPECT_THAT(found(residuals), IsEmpty());
  residuals[77] -= 12.0;
  EXPECT_THAT(found(residuals), ElementsAre(77u));
}

TEST(Outliers, AreNoneWhereAllTheNoiseIsLarger) {
  std::vector<double> residuals = noise(200, 2);
  for (double& residual : residuals) residual *= 10.0;
  EXPECT_THAT(found(residuals), IsEmpty());
}

TEST(Outliers, NeedNeighbours) {
  EXPECT_THAT(found(std::vector<double>{0.0, 0.0, 100.0, 0.0}), IsEmpty());
}

}  // namespace
}  // namespace truebearing::outliers_test
