// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "truebearing/tracker/gate.hpp"

namespace truebearing::gate_test {
namespace {

using Verdict = Gate::Verdict;

TEST(Gate, WithoutThresholdEverythingPasses) {
  Gate gate;
  EXPECT_EQ(gate.judge(0.0), Verdict::passes);
  EXPECT_EQ(gate.judge(1e308), Verdict::passes);
}

TEST(Gate, ThresholdItselfPasses) {
  Gate gate(9.0);
  EXPECT_EQ(gate.judge(9.0), Verdict::passes);
  EXPECT_EQ(gate.judge(std::nextafter(9.0, 10.0)), Verdict::rejected);
}

TEST(Gate, EveryMissWidensItByItsOwnWidth) {
  Gate gate(9.0);
  EXPECT_EQ(gate.judge(81.1), Verdict::rejected);        // one width is 3 standard deviations
  EXPECT_EQ(gate.judge(81.1), Verdict::rejected);        // two: NIS 36
  EXPECT_EQ(gate.judge(81.0), Verdict::passes_widened);  // three: NIS 81
}

TEST(Gate, NarrowsStepByStepAfterWhatOnlyTheWiderLetThroughAndAtOnceAfterAHit) {
  Gate gate(9.0);
  for (int k = 0; k < 3; ++k) EXPECT_EQ(gate.judge(1e6), Verdict::rejected);
  EXPECT_EQ(gate.judge(140.0), Verdict::passes_widened);  // four widths: 144
  EXPECT_EQ(gate.judge(80.0), Verdict::passes_widened);   // three
  EXPECT_EQ(gate.judge(9.0), Verdict::passes);
  EXPECT_EQ(gate.judge(9.1), Verdict::rejected);
}

TEST(Gate, NisThatIsNoNumberNeverPasses) {
  Gate gate(9.0);
  for (int k = 0; k < 100; ++k) EXPECT_EQ(gate.judge(std::numeric_limits<double>::quiet_NaN()), Verdict::rejected);
}

}  // namespace
}  // namespace truebearing::gate_test
