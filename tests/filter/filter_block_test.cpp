// SPDX-License-Identifier: Apache-2.0
#include "truebearing/filter/filter_block.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace truebearing::filter_block_test {
namespace {

TEST(LaneMask, SomeOfTheLanes) {
  constexpr LaneMask kSome = lane_bit(1) | lane_bit(4) | lane_bit(7);
  static_assert(has_lane(kSome, 4) && !has_lane(kSome, 5));
  static_assert(first_lane(kSome) == 1 && first_lane(0) == kPackLanes);
  static_assert(without(kSome, lane_bit(4)) == (lane_bit(1) | lane_bit(7)));
  static_assert(without(kSome, kAllLanes) == 0 && without(kAllLanes, 0) == kAllLanes);
  std::vector<int> lanes;
  for_each_lane(kSome, [&](int lane) { lanes.push_back(lane); });
  EXPECT_EQ(lanes, (std::vector<int>{1, 4, 7}));
  for_each_lane(0, [](int) { ADD_FAILURE() << "there is none"; });
}

TEST(FilterMask, SaysWhichLanesAreAYes) {
  kernels::FilterMask mask{};
  EXPECT_EQ(mask.lanes(), 0);
  for (const int lane : {0, 3, 7}) mask.set(lane, true);
  EXPECT_EQ(mask.lanes(), 0b10001001);
  mask.set(3, false);
  EXPECT_EQ(mask.lanes(), 0b10000001);
  EXPECT_TRUE(mask[7]);
  EXPECT_FALSE(mask[3]);
}

// A lane is one filter's; its neighbours hold what they held.
TEST(FilterBlock, LanesAreSetReadAndCopiedOneByOne) {
  kernels::FilterBlock<3> block{}, other{};
  const Eigen::Vector3d x(1.0, 2.0, 3.0);
  const Eigen::Matrix3d P = (Eigen::Matrix3d() << 4.0, 5.0, 6.0, 5.0, 7.0, 8.0, 6.0, 8.0, 9.0).finished();
  block.set(2, x, P);
  EXPECT_EQ(block.x_of(2), x);
  EXPECT_EQ(block.P_of(2), P);
  other.set(1, 2.0 * x, 2.0 * P);
  other.copy(2, block);
  EXPECT_EQ(other.x_of(2), x);
  EXPECT_EQ(other.P_of(2), P);
  EXPECT_EQ(other.x_of(1), 2.0 * x);
  EXPECT_EQ(other.P_of(3), Eigen::Matrix3d::Zero());
}

// Of a measurement shorter than the block has room for, rows and columns are told apart.
TEST(FilterBlock, LanesOfShorterMatricesStandInTheFirstRowsAndColumns) {
  kernels::UpdateBlock<4> update{};
  const Eigen::Matrix<double, 2, 4> H = Eigen::Matrix<double, 2, 4>::Random();
  kernels::set_lane(H, 5, update.H);
  EXPECT_EQ(update.H[1][3][5], H(1, 3));
  EXPECT_EQ(update.H[2][0][5], 0.0);
  Eigen::Matrix<double, 2, 4> read;
  kernels::read_lane(update.H, 5, read);
  EXPECT_EQ(read, H);
}

TEST(FilterBlock, ManyFiltersStandInARow) {
  std::vector<kernels::FilterMask> blocks(kernels::blocks_of(17));
  EXPECT_EQ(blocks.size(), 3u);
  EXPECT_EQ(&kernels::block_of(blocks, 15), &blocks[1]);
  EXPECT_EQ(&kernels::block_of(blocks, std::size_t{16}), &blocks[2]);
  EXPECT_EQ(kernels::lane_of(15), 7);
  EXPECT_EQ(kernels::lane_of(std::size_t{16}), 0);
  EXPECT_EQ(kernels::lanes_of(2), 4);
  EXPECT_EQ(kernels::lanes_of(5), 8);
  EXPECT_EQ(kernels::lanes_of(9), 16);
}

}  // namespace
}  // namespace truebearing::filter_block_test
