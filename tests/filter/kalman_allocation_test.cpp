// SPDX-License-Identifier: Apache-2.0
#ifdef NDEBUG
#error "Eigen checks for allocations by assertion: compile without NDEBUG"
#endif

#include <gtest/gtest.h>

#include "tests/support/allocation_count.hpp"
#include "truebearing/filter/kalman.hpp"
#include "truebearing/filter/log_polar.hpp"
#include "truebearing/filter/modified_gain.hpp"
#include "truebearing/filter/unscented.hpp"
#include "truebearing/measurement/longer_state.hpp"
#include "truebearing/measurement/position.hpp"
#include "truebearing/measurement/range_bearing.hpp"
#include "truebearing/measurement/range_to_site.hpp"
#include "truebearing/motion/constant_velocity.hpp"
#include "truebearing/motion/turning_target.hpp"

namespace truebearing::kalman_allocation_test {
namespace {

template <typename Filter>
void expect_no_allocation() {
  const ConstantVelocity<2, ContinuousWhiteNoise> motion{{0.5}};
  const Position<2> position{{5.0, 5.0}};
  const RangeToSite<> range{{100.0, 100.0}, 5.0};
  Filter filter(Eigen::Vector4d::Zero(), Eigen::Matrix4d::Identity());
  const long before = testing::allocations;
  Eigen::internal::set_is_malloc_allowed(false);
  bool ok = true;
  for (int k = 0; k < 10; ++k) {
    ok &= filter.predict(motion, 1.0) == StepStatus::ok;
    ok &= filter.update(position, {1.0, 2.0}).status == StepStatus::ok;
    ok &= filter.update(range, Eigen::Matrix<double, 1, 1>(140.0)).status == StepStatus::ok;
  }
  Eigen::internal::set_is_malloc_allowed(true);
  EXPECT_EQ(testing::allocations, before);
  EXPECT_TRUE(ok);
}

template <typename Filter>
void expect_no_allocation_in_a_turn() {
  const TurningTarget<ContinuousWhiteNoise> motion{{0.5}, 0.01};
  const auto model = on_state<5>(RangeBearing<>{{-1000.0, -2000.0}, 5.0, 0.01});
  Filter filter(Filter::State::Zero(), Filter::Covariance::Identity());
  const long before = testing::allocations;
  Eigen::internal::set_is_malloc_allowed(false);
  bool ok = true;
  for (int k = 0; k < 10; ++k) {
    ok &= filter.predict(motion, 1.0) == StepStatus::ok;
    ok &= filter.update(model, {2236.0, 0.46}).status == StepStatus::ok;
  }
  Eigen::internal::set_is_malloc_allowed(true);
  EXPECT_EQ(testing::allocations, before);
  EXPECT_TRUE(ok);
}

TEST(KalmanFilterAllocation, StepsAllocateNothing) {
  expect_no_allocation<KalmanFilter<4, Joseph>>();
  expect_no_allocation<KalmanFilter<4, Conventional>>();
  expect_no_allocation<KalmanFilter<4, SquareRoot>>();
  expect_no_allocation_in_a_turn<KalmanFilter<5>>();
}

TEST(UnscentedKalmanFilterAllocation, StepsAllocateNothing) {
  expect_no_allocation<UnscentedKalmanFilter<4>>();
  expect_no_allocation_in_a_turn<UnscentedKalmanFilter<5>>();
}

template <typename Filter>
void expect_no_allocation_of_bearings() {
  const ConstantVelocity<2, ContinuousWhiteNoise> motion{{1e-5}};
  const Bearing<> model{{-1000.0, -2000.0}, {3.0, 4.0}, 0.02};
  Filter filter(Eigen::Vector4d(4000.0, 3000.0, 1.0, 2.0), 1e4 * Eigen::Matrix4d::Identity());
  const long before = testing::allocations;
  Eigen::internal::set_is_malloc_allowed(false);
  bool ok = true;
  for (int k = 0; k < 10; ++k) {
    ok &= filter.predict(motion, 1.0) == StepStatus::ok;
    ok &= filter.update(model, Bearing<>::Vector(0.8)).status == StepStatus::ok;
  }
  Eigen::internal::set_is_malloc_allowed(true);
  EXPECT_EQ(testing::allocations, before);
  EXPECT_TRUE(ok);
}

TEST(BearingFilterAllocation, StepsAllocateNothing) {
  expect_no_allocation_of_bearings<KalmanFilter<4>>();
  expect_no_allocation_of_bearings<UnscentedKalmanFilter<4>>();
  expect_no_allocation_of_bearings<ModifiedGainFilter<4>>();
  expect_no_allocation_of_bearings<LogPolarFilter<>>();
}

}  // namespace
}  // namespace truebearing::kalman_allocation_test
