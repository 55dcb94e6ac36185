// SPDX-License-Identifier: Apache-2.0
#include "truebearing/tracker/ensemble.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/error_message.hpp"
#include "tests/support/fakes.hpp"
#include "tests/support/line_trackers.hpp"

namespace truebearing::ensemble_test {
namespace {

using testing::error_message;
using testing::position;
using testing::RadarFilter;

// Publishes two tracks in an order of its own.
std::unique_ptr<Tracker> two_tracks(bool swapped) {
  const auto say = [swapped](const Measurement& measurement, std::size_t, testing::FakeTracker::Said& said) {
    for (const int place : {0, 1}) {
      const int track = swapped ? 1 - place : place;
      said.records.push_back(testing::fake_record(line_space(), measurement,
                                                  BoundedVector::Constant(2, 10.0 * track + (swapped ? 1.0 : 0.0)),
                                                  BoundedMatrix::Identity(2, 2)));
      said.records.back().track = track;
    }
  };
  return std::make_unique<testing::FakeTracker>(line_space(), say);
}

TEST(Ensemble, RecordsAreAlignedByTrackNotByPlace) {
  Ensemble ensemble;
  ensemble.add("a", two_tracks(false));
  ensemble.add("b", two_tracks(true));
  ensemble.step(position(1.0, 0.0));
  for (const int track : {0, 1}) {
    ASSERT_NE(ensemble.record(0, track), nullptr);
    ASSERT_NE(ensemble.record(1, track), nullptr);
    EXPECT_EQ(ensemble.record(0, track)->x[0], 10.0 * track);
    EXPECT_EQ(ensemble.record(1, track)->x[0], 10.0 * track + 1.0);
  }
  EXPECT_EQ(ensemble.record(0, 2), nullptr);
}

TEST(Ensemble, BeforeTheFirstStepThereAreNoRecords) {
  Ensemble ensemble;
  ensemble.add("a", RadarFilter{}.tracker());
  EXPECT_TRUE(ensemble.records(0).empty());
  EXPECT_EQ(ensemble.record(0, 0), nullptr);
}

TEST(Ensemble, SecondMemberOfOneNameIsRefused) {
  Ensemble ensemble;
  EXPECT_EQ(ensemble.add("plain", RadarFilter{}.tracker()), 0);
  EXPECT_EQ(ensemble.add("tuned", RadarFilter{}.tracker()), 1);
  EXPECT_THAT(error_message([&] { ensemble.add("plain", RadarFilter{}.tracker()); }), ::testing::HasSubstr("plain"));
  EXPECT_EQ(ensemble.size(), 2);
  EXPECT_EQ(ensemble.index("tuned"), 1);
  EXPECT_EQ(ensemble.index("other"), -1);
}

TEST(Ensemble, EveryMemberSeesEveryMeasurement) {
  Ensemble ensemble;
  RadarFilter wide;
  wide.variance = {1e6, 5e4};
  ensemble.add("plain", RadarFilter{}.tracker());
  ensemble.add("wide", wide.tracker());
  const auto plain_alone = RadarFilter{}.tracker();
  const auto wide_alone = wide.tracker();
  for (const Measurement& measurement : testing::radar_log(2, 30)) {
    ensemble.step(measurement);
    EXPECT_EQ(ensemble.record(0, 0)->x, plain_alone->step(measurement)[0].x);
    EXPECT_EQ(ensemble.record(1, 0)->x, wide_alone->step(measurement)[0].x);
  }
}

TEST(Ensemble, FreshBeginsAnewAndIsIndependent) {
  Ensemble ensemble;
  ensemble.add("plain", RadarFilter{}.tracker());
  for (const Measurement& measurement : testing::radar_log(2, 30)) ensemble.step(measurement);
  Ensemble copy = ensemble.fresh();
  EXPECT_EQ(copy.name(0), "plain");
  EXPECT_TRUE(copy.records(0).empty());
  const BoundedVector before = ensemble.record(0, 0)->x;
  copy.step(position(1.0, 100.0));
  EXPECT_EQ(copy.record(0, 0)->x, RadarFilter{}.tracker()->step(position(1.0, 100.0))[0].x);
  EXPECT_EQ(ensemble.record(0, 0)->x, before);
  ensemble.reset();
  EXPECT_TRUE(ensemble.records(0).empty());
  ensemble.step(position(1.0, 100.0));
  EXPECT_EQ(ensemble.record(0, 0)->x, copy.record(0, 0)->x);
}

// Side by side what can be, one by one what cannot, each on its own measurement or on none.
TEST(EnsemblePack, EveryEnsembleStepsAsByItself) {
  Ensemble prototype;
  prototype.add("two", two_tracks(false));
  prototype.add("plain", RadarFilter{}.tracker());
  std::vector<Ensemble> together, alone;
  for (int i = 0; i < 3; ++i) {
    together.push_back(prototype.fresh());
    alone.push_back(prototype.fresh());
  }
  EnsemblePack pack({&together[0], &together[1], &together[2]});
  for (int k = 1; k <= 12; ++k) {
    const Measurement measured[] = {position(k, 10.0 * k), position(0.5 * k, -7.0 * k), position(2.0 * k, k)};
    const Measurement* given[] = {&measured[0], k % 3 == 0 ? nullptr : &measured[1], &measured[2]};
    pack.step(given);
    for (std::size_t i = 0; i < 3; ++i) {
      if (given[i]) alone[i].step(*given[i]);
      for (const int member : {0, 1}) {
        ASSERT_EQ(together[i].records(member).size(), alone[i].records(member).size());
        for (std::size_t r = 0; r < alone[i].records(member).size(); ++r) {
          EXPECT_EQ(together[i].records(member)[r].time_s, alone[i].records(member)[r].time_s);
          EXPECT_EQ(together[i].records(member)[r].x, alone[i].records(member)[r].x);
        }
      }
    }
  }
  EXPECT_THROW(EnsemblePack({}), std::invalid_argument);
}

}  // namespace
}  // namespace truebearing::ensemble_test
