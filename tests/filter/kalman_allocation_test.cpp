#ifdef NDEBUG
#error "Eigen checks for allocations by assertion: compile without NDEBUG"
#endif

#include <gtest/gtest.h>

#include "tests/support/allocation_count.hpp"
#include "truebearing/filter/kalman.hpp"
#include "truebearing/measurement/position.hpp"
#include "truebearing/measurement/range_to_site.hpp"
#include "truebearing/motion/constant_velocity.hpp"

namespace truebearing {
namespace {

template <typename Form>
void expect_no_allocation() {
  const ConstantVelocity<2, ContinuousWhiteNoise> motion{{0.5}};
  const Position<2> position{{5.0, 5.0}};
  const RangeToSite<> range{{100.0, 100.0}, 5.0};
  KalmanFilter<4, Form> filter(Eigen::Vector4d::Zero(), Eigen::Matrix4d::Identity());
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

TEST(KalmanFilterAllocation, StepsAllocateNothing) {
  expect_no_allocation<Joseph>();
  expect_no_allocation<Conventional>();
  expect_no_allocation<SquareRoot>();
}

}  // namespace
}  // namespace truebearing
