// SPDX-License-Identifier: Apache-2.0
#include "truebearing/array/angle_hypotheses.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/support/array_scene.hpp"
#include "truebearing/core/covariance.hpp"

namespace truebearing::angle_hypotheses_test {
namespace {

using testing::ArrayScene;
using testing::scene_of;

constexpr double kSquareDegree = radians(1.0) * radians(1.0);
constexpr int kIntervals = 50;

AngleHypotheses::Options options(int beam) {
  AngleHypotheses::Options options;
  options.motion = {.q0 = 0.001 * kSquareDegree,
                    .q_low = 0.001 * kSquareDegree,
                    .q_high = kSquareDegree,
                    .log_power_variance_per_s = 1e-3};
  options.beam = beam;
  return options;
}

// Two targets of equal power that cross slowly, at 25 s, and one that keeps away.
ArrayScene scene_at(int k, double rate_degps) {
  const double apart_deg = rate_degps * (k - 25);
  return scene_of({10.0 + 0.5 * apart_deg, 10.0 - 0.5 * apart_deg, -40.0}, 1.0);
}

JointAngleState start(double rate_degps) {
  const ArrayScene scene = scene_at(0, rate_degps);
  JointAngleState state;
  state.x.setZero(9);
  state.P.setZero(9, 9);
  state.q.setConstant(3, 0.001 * kSquareDegree);
  state.innovations.setZero(3);
  for (int n = 0; n < 3; ++n) {
    state.x[n] = scene.angles_rad[static_cast<std::size_t>(n)];
    state.P(n, n) = radians(0.5) * radians(0.5);
    state.P(3 + n, 3 + n) = 0.25;
    state.P(6 + n, 6 + n) = radians(0.5) * radians(0.5);
  }
  return state;
}

RealInterval interval(RandomStream& random, const ArrayScene& scene) {
  RealInterval taken;
  taken.take(scene.draw_interval(random), 1);
  return taken;
}

// Calls seen(hypotheses) after each interval; true where the two end exchanged.
template <typename Seen>
bool ends_swapped(int beam, std::uint64_t run, double rate_degps, const Seen& seen) {
  RandomStream random({21, Role::evaluation, run}, StreamId::test);
  AngleHypotheses hypotheses;
  hypotheses.begin(options(beam), start(rate_degps));
  for (int k = 1; k < kIntervals; ++k) {
    EXPECT_TRUE(hypotheses.update(interval(random, scene_at(k, rate_degps)), 1.0, 0.0)) << k;
    seen(hypotheses);
  }
  const JointAngleState& state = hypotheses.best().state;
  return state.angle(0) < state.angle(1);
}

int swaps(int beam, double rate_degps) {
  int count = 0;
  for (std::uint64_t run = 0; run < 40; ++run)
    count += ends_swapped(beam, run, rate_degps, [](const AngleHypotheses&) {});
  return count;
}

TEST(AngleHypotheses, SwapFewerTargetsThanOneFilter) {
  const int one = swaps(1, 0.2), eight = swaps(8, 0.2);
  EXPECT_GE(one, 4);
  EXPECT_LE(2 * eight, one);
}

// Whoever is called which.
bool is_same(const AngleHypothesis& a, const AngleHypothesis& b, const AngleHypotheses::Options& o) {
  std::array<int, kMaxSignals> in_a{}, in_b{};
  order_of_angles(a.state, in_a);
  order_of_angles(b.state, in_b);
  for (std::size_t n = 0; n < 3; ++n) {
    const double angle = std::abs(a.state.angle(in_a[n]) - b.state.angle(in_b[n]));
    const double rate = std::abs(a.state.rate(in_a[n]) - b.state.rate(in_b[n]));
    const double angle_sigma = std::sqrt(a.state.P(in_a[n], in_a[n]));
    const double rate_sigma = std::sqrt(a.state.P(6 + in_a[n], 6 + in_a[n]));
    if (angle > std::min(o.same_rad, o.same_sigmas * angle_sigma)) return false;
    if (rate > std::min(o.same_radps, o.same_sigmas * rate_sigma)) return false;
  }
  return true;
}

TEST(AngleHypotheses, AreSortedDistinctAndNoMoreThanTheBeam) {
  int most = 0, last = 0;
  for (const int beam : {2, 8})
    for (std::uint64_t run = 0; run < 5; ++run) {
      ends_swapped(beam, run, 0.4, [&](const AngleHypotheses& hypotheses) {
        ASSERT_GE(hypotheses.count(), 1);
        ASSERT_LE(hypotheses.count(), beam);
        EXPECT_EQ(hypotheses.best().log_weight, 0.0);
        for (int h = 0; h < hypotheses.count(); ++h) {
          EXPECT_TRUE(is_covariance(hypotheses.hypothesis(h).state.P));
          EXPECT_GE(hypotheses.hypothesis(h).log_weight, -12.0);
          for (int other = 0; other < h; ++other) {
            EXPECT_LE(hypotheses.hypothesis(h).log_weight, hypotheses.hypothesis(other).log_weight);
            EXPECT_FALSE(is_same(hypotheses.hypothesis(other), hypotheses.hypothesis(h), options(beam)));
          }
        }
        most = std::max(most, hypotheses.count());
        last = hypotheses.count();
      });
      EXPECT_LE(last, 2) << run;  // long after the crossing the motion has told
    }
  EXPECT_GE(most, 3);
}

TEST(AngleHypotheses, WithABeamOfOneAreTheFilter) {
  RandomStream random({22, Role::evaluation, 0}, StreamId::test);
  AngleHypotheses hypotheses;
  hypotheses.begin(options(1), start(0.4));
  JointAngleState state = start(0.4);
  JointAngleUpdate update;
  for (int k = 1; k < 10; ++k) {
    const RealInterval heard = interval(random, scene_at(k, 0.4));
    ASSERT_TRUE(hypotheses.update(heard, 1.0, 0.0));
    JointAngleState prior = state, after;
    predict(prior, options(1).motion, 1.0);
    ASSERT_TRUE(update.run(prior, heard, 0.0, prior.x.head(6), {}, after));
    adapt(options(1).motion, prior, after);
    state = after;
    EXPECT_EQ(hypotheses.count(), 1);
    EXPECT_EQ(hypotheses.best().state.x, state.x);
    EXPECT_EQ(hypotheses.best().state.P, state.P);
    EXPECT_EQ(hypotheses.best().state.q, state.q);
    EXPECT_EQ(hypotheses.best().prior.x, prior.x);
  }
}

TEST(AngleHypotheses, FarFromEachOtherTargetsGiveNone) {
  RandomStream random({23, Role::evaluation, 0}, StreamId::test);
  AngleHypotheses hypotheses;
  JointAngleState state = start(0.0);
  state.x.head(3) << radians(-40.0), radians(0.0), radians(30.0);
  hypotheses.begin(options(8), state);
  for (int k = 0; k < 10; ++k) {
    ASSERT_TRUE(hypotheses.update(interval(random, scene_of({-40.0, 0.0, 30.0}, 1.0)), 1.0, 0.0));
    EXPECT_EQ(hypotheses.count(), 1);
  }
}

// Two modes of one posterior that differ only in which target has which name explain all that comes equally well.
TEST(AngleHypotheses, EqualUpToAnExchangeAreMerged) {
  RandomStream random({24, Role::evaluation, 0}, StreamId::test);
  AngleHypotheses hypotheses;
  JointAngleState state = start(0.0);
  // Symmetric in the first two targets, rates and all, and not certain of which is which.
  state.x.head(3) << radians(9.0), radians(11.0), radians(-40.0);
  for (const int n : {0, 1}) state.P(n, n) = radians(2.0) * radians(2.0);
  hypotheses.begin(options(8), state);
  ASSERT_TRUE(hypotheses.update(interval(random, scene_of({9.0, 11.0, -40.0}, 10.0)), 1.0, 0.0));
  for (int h = 1; h < hypotheses.count(); ++h)
    EXPECT_FALSE(is_same(hypotheses.best(), hypotheses.hypothesis(h), options(8)));
}

TEST(AngleHypotheses, StayAsTheyWereWhereNothingCanBeScored) {
  RandomStream random({25, Role::evaluation, 0}, StreamId::test);
  AngleHypotheses hypotheses;
  hypotheses.begin(options(8), start(0.4));
  ASSERT_TRUE(hypotheses.update(interval(random, scene_at(1, 0.4)), 1.0, 0.0));
  const AngleHypothesis before = hypotheses.best();
  EXPECT_FALSE(hypotheses.update(interval(random, scene_at(2, 0.4)), std::nan(""), 0.0));
  EXPECT_EQ(hypotheses.best().state.x, before.state.x);
  EXPECT_EQ(hypotheses.best().state.P, before.state.P);
  EXPECT_TRUE(hypotheses.update(interval(random, scene_at(2, 0.4)), 1.0, 0.0));
}

TEST(AngleHypotheses, ChangeReachesAllOfThem) {
  int most = 0;
  for (std::uint64_t run = 0; run < 5; ++run) {
    RandomStream random({21, Role::evaluation, run}, StreamId::test);
    AngleHypotheses hypotheses;
    hypotheses.begin(options(8), start(0.4));
    for (int k = 1; k < kIntervals && hypotheses.count() == 1; ++k)
      hypotheses.update(interval(random, scene_at(k, 0.4)), 1.0, 0.0);
    hypotheses.change([](AngleHypothesis& hypothesis) { remove_target(hypothesis.state, 2); });
    for (int h = 0; h < hypotheses.count(); ++h) EXPECT_EQ(hypotheses.hypothesis(h).state.targets(), 2);
    most = std::max(most, hypotheses.count());
  }
  EXPECT_GT(most, 1);
}

}  // namespace
}  // namespace truebearing::angle_hypotheses_test
