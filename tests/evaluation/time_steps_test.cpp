// SPDX-License-Identifier: Apache-2.0
#include "truebearing/evaluation/time_steps.hpp"

#include <gtest/gtest.h>

#include "tests/support/line_trackers.hpp"

#include "truebearing/core/constants.hpp"

namespace truebearing::time_steps_test {
namespace {

Recording recording(const std::vector<double>& times_s) {
  Recording made;
  made.truth.resize(1);
  for (const double time_s : times_s) {
    made.measurements.push_back(testing::position(time_s, 0.0));
    made.truth[0].x.emplace_back(Eigen::Vector2d::Zero());
  }
  return made;
}

TEST(StepsAt, AreTheLastUntilThen) {
  EXPECT_EQ(steps_at(recording({0.0, 4.0, 8.0}), {0.0, 3.9, 4.0, 7.9999995, 8.0, 12.0}),
            (std::vector<int>{0, 0, 1, 2, 2, 2}));
  EXPECT_EQ(steps_at(recording({5.0, 9.0}), {4.0, 13.0, 13.1, 500.0}), (std::vector<int>{-1, 1, -1, -1}))
      << "before the first measurement, and after a run has ended";
  EXPECT_EQ(steps_at(recording({1.0, 1.0}), {1.0}), (std::vector<int>{1})) << "of two at once, the second";
  Recording unknown = recording({0.0, 4.0});
  unknown.truth[0].x[1].setConstant(kNaN);
  EXPECT_EQ(steps_at(unknown, {0.0, 4.0}), (std::vector<int>{0, -1}));
}

}  // namespace
}  // namespace truebearing::time_steps_test
