// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "tests/support/line_trackers.hpp"
#include "truebearing/core/constants.hpp"
#include "truebearing/tracker/stream_guard.hpp"

namespace truebearing::stream_guard_test {
namespace {

using testing::position;
using Verdict = StreamGuard::Verdict;

TEST(StreamGuard, MeasurementsInOrderAreUsable) {
  StreamGuard guard;
  EXPECT_EQ(guard.examine(position(-5.0, 1.0)), Verdict::usable);
  EXPECT_EQ(guard.examine(position(-4.0, 1.0)), Verdict::usable);
  EXPECT_EQ(guard.examine(position(-4.0, 2.0)), Verdict::usable) << "the same time, another value";
}

TEST(StreamGuard, ValuesThatAreNoNumbersAreMissingAndCounted) {
  StreamGuard guard;
  EXPECT_EQ(guard.examine(position(1.0, kNaN)), Verdict::missing);
  EXPECT_EQ(guard.examine(position(2.0, kInfinity)), Verdict::missing);
  EXPECT_EQ(guard.examine(Measurement{.time_s = 3.0, .z = {}, .sigma = {}, .sensor = {}}), Verdict::missing);
  EXPECT_EQ(guard.counts.missing, 3);
}

TEST(StreamGuard, RepetitionIsFoundAlsoBehindAMissingOne) {
  StreamGuard guard;
  EXPECT_EQ(guard.examine(position(1.0, 5.0)), Verdict::usable);
  EXPECT_EQ(guard.examine(position(1.0, kNaN)), Verdict::missing);
  EXPECT_EQ(guard.examine(position(1.0, 5.0)), Verdict::repeated);
  EXPECT_EQ(guard.examine(position(2.0, 5.0)), Verdict::usable) << "the same value at another time is no repetition";
  EXPECT_EQ(guard.counts.repeated, 1);
}

TEST(StreamGuard, EarlierTimesAndTimesThatAreNoNumbersAreOutOfOrder) {
  StreamGuard guard;
  EXPECT_EQ(guard.examine(position(kNaN, 5.0)), Verdict::out_of_order);
  EXPECT_EQ(guard.examine(position(10.0, 5.0)), Verdict::usable);
  EXPECT_EQ(guard.examine(position(9.999, 6.0)), Verdict::out_of_order);
  EXPECT_EQ(guard.examine(position(kInfinity, 6.0)), Verdict::out_of_order);
  EXPECT_EQ(guard.examine(position(10.0, 6.0)), Verdict::usable) << "a late one moves no clock";
  EXPECT_EQ(guard.counts.out_of_order, 3);
}

}  // namespace
}  // namespace truebearing::stream_guard_test
