// SPDX-License-Identifier: Apache-2.0
#include "truebearing/tracker/filter_tracker_pack.hpp"

#include <gtest/gtest.h>

#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "truebearing/core/constants.hpp"
#include "truebearing/core/random.hpp"
#include "truebearing/filter/filter_kinds.hpp"
#include "truebearing/filter/interacting_multiple_model.hpp"
#include "truebearing/motion/constant_acceleration.hpp"
#include "truebearing/motion/constant_velocity.hpp"
#include "truebearing/tracker/filter_tracker.hpp"
#include "truebearing/tracker/polar_sensor.hpp"
#include "truebearing/tracker/position_sensor.hpp"

namespace truebearing::filter_tracker_pack_test {
namespace {

using Noise = DiscreteWhiteNoise;

void expect_same(const StepRecord& a, const StepRecord& b) {
  EXPECT_EQ(a.track, b.track);
  EXPECT_EQ(a.time_s, b.time_s);
  EXPECT_EQ(a.status, b.status);
  EXPECT_EQ(a.source, b.source);
  EXPECT_EQ(a.x, b.x);
  EXPECT_EQ(a.P, b.P);
  ASSERT_EQ(a.prediction.has_value(), b.prediction.has_value());
  if (a.prediction) {
    EXPECT_EQ(a.prediction->x, b.prediction->x);
    EXPECT_EQ(a.prediction->P, b.prediction->P);
  }
  ASSERT_EQ(a.innovation.has_value(), b.innovation.has_value());
  if (a.innovation) {
    EXPECT_EQ(a.innovation->z, b.innovation->z);
    EXPECT_EQ(a.innovation->nu, b.innovation->nu);
    EXPECT_EQ(a.innovation->S, b.innovation->S);
    EXPECT_EQ(a.innovation->nis, b.innovation->nis);
  }
  ASSERT_EQ(a.gain.has_value(), b.gain.has_value());
  if (a.gain) {
    EXPECT_EQ(*a.gain, *b.gain);
  }
  ASSERT_EQ(a.mode_probabilities.has_value(), b.mode_probabilities.has_value());
  if (a.mode_probabilities) {
    EXPECT_EQ(*a.mode_probabilities, *b.mode_probabilities);
  }
}

// The rough day of one target: outages, repeated and late rows, plots that are not its own, a jump to another place.
std::vector<Measurement> rough_day(std::uint64_t run, bool polar) {
  RandomStream random({7, Role::evaluation, run}, StreamId::test);
  std::vector<Measurement> day;
  Eigen::Vector2d place(4000.0 + 50.0 * static_cast<double>(run), 3000.0), velocity(60.0, -40.0);
  double time_s = 0.0;
  for (int k = 0; k < 160; ++k) {
    const double dt_s = random.uniform() < 0.03 ? 45.0 : random.uniform() < 0.3 ? 0.5 : 1.0;
    time_s += dt_s;
    place += dt_s * velocity;
    if (k % 40 == 39) velocity = Eigen::Vector2d(-velocity[1], velocity[0]);
    if (run % 3 == 2 && k == 90) place += Eigen::Vector2d(2e4, -1e4);
    Measurement measurement;
    measurement.time_s = time_s;
    Eigen::Vector2d seen = place;
    if (random.uniform() < 0.05) seen += Eigen::Vector2d(3000.0, 4000.0) * random.normal();
    measurement.z = polar ? Eigen::Vector2d(seen.norm() + 30.0 * random.normal(),
                                            std::atan2(seen[0], seen[1]) + 0.005 * random.normal())
                          : Eigen::Vector2d(seen + 30.0 * Eigen::Vector2d(random.normal(), random.normal()));
    if (random.uniform() < 0.08) measurement.z = BoundedVector::Constant(2, kNaN);
    day.push_back(measurement);
    if (random.uniform() < 0.05) day.push_back(measurement);
    if (random.uniform() < 0.03) {
      measurement.time_s -= 2.0;
      day.push_back(measurement);
    }
  }
  return day;
}

struct Kind {
  std::string name;
  std::unique_ptr<FilterTracker> (*make)();
  bool polar;
  bool packs = true;
};

std::unique_ptr<TrackedState> two_modes() {
  InteractingMultipleModel::Modes modes;
  modes.push_back(state_of<KalmanFilter<4>>(ConstantVelocity<2, Noise>{{0.5}}));
  modes.push_back(state_of<KalmanFilter<4>>(ConstantVelocity<2, Noise>{{20.0}}));
  return std::make_unique<InteractingMultipleModel>(std::move(modes), star_chain(2, 0.05, 0.1, 1.0, 1.0));
}

std::unique_ptr<AnySensor> positions() {
  return sensor_of(PositionSensor<2>{Eigen::Vector2d(30.0, 30.0), 1.0});
}
std::unique_ptr<AnySensor> ranges_and_bearings() {
  return sensor_of(PolarSensor{.sigma = Eigen::Vector2d(30.0, 0.005)});
}

std::unique_ptr<TrackedState> constant_velocity() {
  return state_of<KalmanFilter<4>>(ConstantVelocity<2, Noise>{{2.0}});
}

const Kind kKinds[] = {
    {"Plain",
     [] { return std::make_unique<FilterTracker>(plane_space(), constant_velocity(), positions(), TwoPointStart{}); },
     false},
    {"Gated",
     [] {
       return std::make_unique<FilterTracker>(plane_space(), constant_velocity(), positions(), TwoPointStart{},
                                              FilterTrackerOptions{.gate_nis = 13.8, .lost_after_s = 40.0});
     },
     false},
    {"Prior",
     [] {
       const BoundedMatrix P = Eigen::Vector4d(1e6, 1e6, 1e4, 1e4).asDiagonal().toDenseMatrix();
       return std::make_unique<FilterTracker>(plane_space(), constant_velocity(), ranges_and_bearings(),
                                              PriorStart{Eigen::Vector4d(4000.0, 3000.0, 0.0, 0.0), P},
                                              FilterTrackerOptions{.gate_nis = 20.0});
     },
     true},
    {"MultipleModel",
     [] {
       return std::make_unique<FilterTracker>(plane_space(), two_modes(), positions(), TwoPointStart{},
                                              FilterTrackerOptions{.gate_nis = 13.8, .lost_after_s = 40.0});
     },
     false},
    {"LongerThanItsSpace",
     [] {
       return std::make_unique<FilterTracker>(
           plane_space(), state_of<KalmanFilter<6>>(ConstantAcceleration<2, ContinuousWhiteJerk>{{0.5}}), positions(),
           TwoPointStart{}, FilterTrackerOptions{.gate_nis = 13.8});
     },
     false},
};

class FilterTrackerPackOf : public ::testing::TestWithParam<std::size_t> {};

// What the pack says, what each says alone, and what both count, over rough days, with a reset in between and a look at
// the state, which fetches it out of the pack.
TEST_P(FilterTrackerPackOf, StepsAreThoseOfEachAlone) {
  const Kind& kind = kKinds[GetParam()];
  std::vector<std::unique_ptr<FilterTracker>> together, alone;
  std::vector<std::vector<Measurement>> days;
  for (int i = 0; i < kPackLanes; ++i) {
    together.push_back(kind.make());
    alone.push_back(kind.make());
    days.push_back(rough_day(static_cast<std::uint64_t>(i), kind.polar));
  }
  const std::unique_ptr<TrackerPack> pack = together.front()->pack();
  if (!pack) GTEST_SKIP() << "no pack on this processor";
  std::vector<TrackerPack::Lane> lanes(kPackLanes);
  int ordinary = 0;
  for (std::size_t k = 0; k < 190; ++k) {
    for (std::size_t i = 0; i < lanes.size(); ++i)
      lanes[i] = {together[i].get(), k < days[i].size() ? &days[i][k] : nullptr};
    if (k == 70) {
      together[2]->reset();
      alone[2]->reset();
    }
    if (k % 10 == 9 && !alone[5]->is_lost()) {
      EXPECT_EQ(together[5]->state().x(), alone[5]->state().x());
    }
    if (k == 100) {
      EXPECT_TRUE(together[6]->assign(*together[7]));
      EXPECT_TRUE(alone[6]->assign(*alone[7]));
    }
    pack->step(lanes);
    for (std::size_t i = 0; i < lanes.size(); ++i) {
      if (!lanes[i].measurement) {
        EXPECT_TRUE(lanes[i].records.empty());
        continue;
      }
      const std::span<const StepRecord> own = alone[i]->step(days[i][k]);
      ASSERT_EQ(lanes[i].records.size(), own.size()) << "lane " << i << " step " << k;
      if (own.empty()) continue;
      expect_same(lanes[i].records[0], own[0]);
      ordinary += own[0].status == StepStatus::ok ? 1 : 0;
      if (HasFailure()) {
        ADD_FAILURE() << "lane " << i << " step " << k;
        return;
      }
    }
  }
  EXPECT_GT(ordinary, 700) << "a day may be rough, but most steps are ordinary";
  for (std::size_t i = 0; i < lanes.size(); ++i) {
    EXPECT_EQ(together[i]->counts().missing, alone[i]->counts().missing);
    EXPECT_EQ(together[i]->counts().repeated, alone[i]->counts().repeated);
    EXPECT_EQ(together[i]->counts().out_of_order, alone[i]->counts().out_of_order);
    EXPECT_EQ(together[i]->counts().gated, alone[i]->counts().gated);
    EXPECT_EQ(together[i]->counts().failed, alone[i]->counts().failed);
  }
}

INSTANTIATE_TEST_SUITE_P(Kinds, FilterTrackerPackOf, ::testing::Range(std::size_t{0}, std::size(kKinds)),
                         [](const auto& kind) { return kKinds[kind.param].name; });

TEST(FilterTrackerPack, IsNotOfTrackersThatPublishSomethingElse) {
  EXPECT_FALSE(
      FilterTracker(plane_space(), constant_velocity(), positions(), TwoPointStart{}, {.output_pull = 0.5}).pack());
  EXPECT_FALSE(
      FilterTracker(plane_space(), constant_velocity(), positions(), TwoPointStart{}, {.ahead_s = 2.0}).pack());
  EXPECT_FALSE(FilterTracker(plane_space(), state_of<UnscentedKalmanFilter<4>>(ConstantVelocity<2, Noise>{{2.0}}),
                             positions(), TwoPointStart{})
                   .pack());
}

// A tracker outlives the pack that it was stepped in.
TEST(FilterTrackerPack, TrackersGoOnWithoutIt) {
  const auto tracker = kKinds[0].make(), other = kKinds[0].make(), alone = kKinds[0].make();
  const std::vector<Measurement> day = rough_day(1, false);
  {
    const std::unique_ptr<TrackerPack> pack = tracker->pack();
    if (!pack) GTEST_SKIP() << "no pack on this processor";
    for (std::size_t k = 0; k < 20; ++k) {
      std::vector<TrackerPack::Lane> lanes{{tracker.get(), &day[k]}, {other.get(), &day[k]}};
      pack->step(lanes);
      alone->step(day[k]);
    }
  }
  for (std::size_t k = 20; k < 40; ++k) expect_same(tracker->step(day[k])[0], alone->step(day[k])[0]);
}

}  // namespace
}  // namespace truebearing::filter_tracker_pack_test
