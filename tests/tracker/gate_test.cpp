#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "truebearing/tracker/gate.hpp"

namespace truebearing::gate_test {
namespace {

TEST(Gate, WithoutThresholdEverythingPasses) {
  Gate gate;
  EXPECT_TRUE(gate.passes(0.0));
  EXPECT_TRUE(gate.passes(1e308));
}

TEST(Gate, ThresholdItselfPasses) {
  Gate gate(9.0);
  EXPECT_TRUE(gate.passes(9.0));
  EXPECT_FALSE(gate.passes(std::nextafter(9.0, 10.0)));
}

TEST(Gate, EveryMissWidensItByItsOwnWidth) {
  Gate gate(9.0);
  EXPECT_FALSE(gate.passes(81.1));  // one width is 3 standard deviations
  EXPECT_FALSE(gate.passes(81.1));  // two: NIS 36
  EXPECT_TRUE(gate.passes(81.0));   // three: NIS 81
}

TEST(Gate, HitNarrowsItAgain) {
  Gate gate(9.0);
  EXPECT_FALSE(gate.passes(100.0));
  EXPECT_TRUE(gate.passes(36.0));
  EXPECT_FALSE(gate.passes(9.1));
}

TEST(Gate, NisThatIsNoNumberNeverPasses) {
  Gate gate(9.0);
  for (int k = 0; k < 100; ++k) EXPECT_FALSE(gate.passes(std::numeric_limits<double>::quiet_NaN()));
}

}  // namespace
}  // namespace truebearing::gate_test
