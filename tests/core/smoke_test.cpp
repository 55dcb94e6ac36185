#include <gtest/gtest.h>
#include "truebearing/core/covariance.hpp"
#include "truebearing/core/random.hpp"
#include "truebearing/tracker/tracker.hpp"
#include "truebearing/motion/motion_model.hpp"
#include "truebearing/measurement/measurement_model.hpp"
#include "truebearing/correction/fuzzy_network.hpp"
#include "truebearing/core/chi_square.hpp"
using namespace truebearing;
TEST(Smoke, Works) {
  Eigen::Matrix2d A; A << 2, 1, 1, 2;
  EXPECT_TRUE(is_covariance(A));
  A << 1, 2, 2, 1;
  EXPECT_FALSE(is_covariance(A));
  RandomStream s({1, Role::evaluation, 0}, StreamId::test);
  EXPECT_NE(s.normal(), s.normal());
  EXPECT_NEAR(chi_square_quantile(.95, 2), 5.99, .01);
}
