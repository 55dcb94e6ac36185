// SPDX-License-Identifier: Apache-2.0
// Targets at a line array that come and go, held to what the defaults of `lifetimes` were tuned to; two standard errors
// are allowed on top.
#include <gtest/gtest.h>

#include "tests/support/comparisons.hpp"

namespace truebearing::array_births_test {
namespace {

using testing::load_study;
using testing::metric;
using testing::run_members;

TEST(ArrayBirths, FewTargetsAreMissedAndFewTracksFalse) {
  const Comparison comparison = run_members(load_study("array_births"), {"joint"}, 60);
  const auto expect_below = [&](const char* name, double bar) {
    const Metric found = metric(comparison, "joint", name, 0.0);
    EXPECT_LT(found.value, bar + 2.0 * found.se) << name;
    EXPECT_GT(found.value, 0.0) << name;
  };
  expect_below("missed_targets", 0.025);
  expect_below("false_tracks", 0.07);
  expect_below("gospa", 1.1);
}

}  // namespace
}  // namespace truebearing::array_births_test
