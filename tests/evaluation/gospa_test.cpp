// SPDX-License-Identifier: Apache-2.0
#include "truebearing/evaluation/gospa.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <set>
#include <vector>

#include "truebearing/core/random.hpp"

namespace truebearing::gospa_test {
namespace {

using Values = std::vector<double>;

// The least d^2 over every assignment there is, by the definition.
double brute_force(const Values& targets, const Values& tracks, double cutoff) {
  double least = std::numeric_limits<double>::infinity();
  std::vector<bool> used(tracks.size(), false);
  const std::function<void(std::size_t, double, std::size_t)> assign = [&](std::size_t target, double sum,
                                                                           std::size_t pairs) {
    if (target == targets.size()) {
      const double alone = static_cast<double>(targets.size() + tracks.size() - 2 * pairs);
      least = std::min(least, sum + 0.5 * cutoff * cutoff * alone);
      return;
    }
    assign(target + 1, sum, pairs);
    for (std::size_t track = 0; track < tracks.size(); ++track) {
      if (used[track]) continue;
      used[track] = true;
      const double d = targets[target] - tracks[track];
      assign(target + 1, sum + d * d, pairs + 1);
      used[track] = false;
    }
  };
  assign(0, 0.0, 0);
  return least;
}

TEST(Gospa, ByHand) {
  const Gospa found = gospa(Values{10.0, -20.0, 40.0}, Values{-19.0, 12.0, 70.0, -60.0}, 5.0);
  EXPECT_EQ(found.track_of, (std::vector<int>{1, 0, -1}));
  EXPECT_DOUBLE_EQ(found.localisation, 4.0 + 1.0);
  EXPECT_EQ(found.missed, 1);
  EXPECT_EQ(found.false_tracks, 2);
  EXPECT_DOUBLE_EQ(found.squared(5.0), 5.0 + 12.5 * 3.0);
}

TEST(Gospa, OfNothingIsNothing) {
  EXPECT_EQ(gospa({}, {}, 5.0).squared(5.0), 0.0);
  EXPECT_EQ(gospa(Values{1.0, 2.0}, {}, 5.0).missed, 2);
  EXPECT_EQ(gospa({}, Values{1.0}, 5.0).false_tracks, 1);
  EXPECT_DOUBLE_EQ(gospa({}, Values{1.0}, 4.0).squared(4.0), 8.0);
}

TEST(Gospa, AssignsAllTogetherNotTheNearestFirst) {
  // The nearest pair, 0 and 0.9, would leave 2 with -1.2.
  const Gospa found = gospa(Values{0.0, 2.0}, Values{0.9, -1.2}, 10.0);
  EXPECT_EQ(found.track_of, (std::vector<int>{1, 0}));
}

TEST(Gospa, PairsBeyondTheCutoffAreMissedAndFalse) {
  EXPECT_EQ(gospa(Values{0.0}, Values{4.9}, 5.0).track_of, std::vector<int>{0});
  const Gospa apart = gospa(Values{0.0}, Values{5.1}, 5.0);
  EXPECT_EQ(apart.track_of, std::vector<int>{-1});
  EXPECT_EQ(apart.missed + apart.false_tracks, 2);
}

TEST(Gospa, IsTheLeastOverAllAssignments) {
  RandomStream random({.seed = 11}, StreamId::test);
  for (int trial = 0; trial < 400; ++trial) {
    const auto drawn = [&] {
      Values values(static_cast<std::size_t>(random.uniform(0.0, 6.0)));
      for (double& value : values) value = random.uniform(-8.0, 8.0);
      return values;
    };
    const Values targets = drawn(), tracks = drawn();
    const double cutoff = random.uniform(1.0, 8.0);
    const Gospa found = gospa(targets, tracks, cutoff);
    ASSERT_NEAR(found.squared(cutoff), brute_force(targets, tracks, cutoff), 1e-9) << trial;

    // What it says of itself is the assignment that it names.
    double localisation = 0.0;
    std::set<int> used;
    for (std::size_t i = 0; i < targets.size(); ++i) {
      if (found.track_of[i] < 0) continue;
      const double d = targets[i] - tracks[static_cast<std::size_t>(found.track_of[i])];
      localisation += d * d;
      EXPECT_LE(std::abs(d), cutoff);
      EXPECT_TRUE(used.insert(found.track_of[i]).second) << "a track of two targets";
    }
    EXPECT_NEAR(found.localisation, localisation, 1e-12 * (1.0 + localisation));
    EXPECT_EQ(found.missed, static_cast<int>(targets.size() - used.size()));
    EXPECT_EQ(found.false_tracks, static_cast<int>(tracks.size() - used.size()));
  }
}

TEST(Gospa, OrderOfTheListsDoesNotMatter) {
  const Values targets{3.0, -1.0, 7.0}, tracks{6.5, -0.5, 3.5};
  const Values reversed(tracks.rbegin(), tracks.rend());
  EXPECT_EQ(gospa(targets, tracks, 2.0).track_of, (std::vector<int>{2, 1, 0}));
  EXPECT_EQ(gospa(targets, reversed, 2.0).track_of, (std::vector<int>{0, 1, 2}));
}

}  // namespace
}  // namespace truebearing::gospa_test
