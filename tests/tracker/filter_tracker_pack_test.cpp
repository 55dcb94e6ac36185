// SPDX-License-Identifier: Apache-2.0
#include "truebearing/tracker/filter_tracker_pack.hpp"

#include <gtest/gtest.h>

#include <bit>
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
#include "truebearing/tracker/several_sensors.hpp"

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

// Positions, ranges and bearings, or now the one and now the other, each by a sensor of its own.
enum class Seen { as_position, as_polar, as_both };

// The rough day of one target: outages, repeated and late rows, plots that are not its own, a jump to another place.
std::vector<Measurement> rough_day(std::uint64_t run, Seen by) {
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
    if (by == Seen::as_both) measurement.source = random.uniform() < 0.3 ? 1 : 0;
    measurement.z = by == Seen::as_polar || measurement.source == 1
                        ? Eigen::Vector2d(seen.norm() + 30.0 * random.normal(),
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
  Seen seen;
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
     Seen::as_position},
    {"Gated",
     [] {
       return std::make_unique<FilterTracker>(plane_space(), constant_velocity(), positions(), TwoPointStart{},
                                              FilterTrackerOptions{.gate_nis = 13.8, .lost_after_s = 40.0});
     },
     Seen::as_position},
    {"Prior",
     [] {
       const BoundedMatrix P = Eigen::Vector4d(1e6, 1e6, 1e4, 1e4).asDiagonal().toDenseMatrix();
       return std::make_unique<FilterTracker>(plane_space(), constant_velocity(), ranges_and_bearings(),
                                              PriorStart{Eigen::Vector4d(4000.0, 3000.0, 0.0, 0.0), P},
                                              FilterTrackerOptions{.gate_nis = 20.0});
     },
     Seen::as_polar},
    {"MultipleModel",
     [] {
       return std::make_unique<FilterTracker>(plane_space(), two_modes(), positions(), TwoPointStart{},
                                              FilterTrackerOptions{.gate_nis = 13.8, .lost_after_s = 40.0});
     },
     Seen::as_position},
    {"LongerThanItsSpace",
     [] {
       return std::make_unique<FilterTracker>(
           plane_space(), state_of<KalmanFilter<6>>(ConstantAcceleration<2, ContinuousWhiteJerk>{{0.5}}), positions(),
           TwoPointStart{}, FilterTrackerOptions{.gate_nis = 13.8});
     },
     Seen::as_position},
    {"SeveralSensors",
     [] {
       std::vector<SeveralSensors::Part> parts;
       parts.push_back({"positions", positions()});
       parts.push_back({"radar", ranges_and_bearings()});
       return std::make_unique<FilterTracker>(plane_space(), two_modes(),
                                              std::make_unique<SeveralSensors>(std::move(parts)), TwoPointStart{},
                                              FilterTrackerOptions{.lost_after_s = 40.0, .gate_nis_of = {13.8, 20.0}});
     },
     Seen::as_both},
};

// Counts the steps that went through a pack.
class Counting final : public StatePack {
 public:
  explicit Counting(std::unique_ptr<StatePack> real) : real_(std::move(real)) {}

  int kept = 0;

  int free_lane() const override { return real_->free_lane(); }
  void enter(int lane, const TrackedState& state) override { real_->enter(lane, state); }
  void leave(int lane, TrackedState& state) override { real_->leave(lane, state); }
  void drop(int lane) override { real_->drop(lane); }
  LaneMask predict(LaneMask lanes, const double* dt_s) override { return real_->predict(lanes, dt_s); }
  LaneMask update(LaneMask lanes, const AnyMeasurement* const* taken) override { return real_->update(lanes, taken); }
  void keep(LaneMask lanes) override {
    kept += std::popcount(lanes);
    real_->keep(lanes);
  }
  LaneMask within(LaneMask lanes, int positions, double farthest) const override {
    return real_->within(lanes, positions, farthest);
  }
  void estimate(int lane, double* x, double* P) const override { real_->estimate(lane, x, P); }
  void update_of(int lane, const StateUpdateTarget& update) const override { real_->update_of(lane, update); }
  void mode_probabilities(int lane, ModeVector& mu) const override { real_->mode_probabilities(lane, mu); }

 private:
  std::unique_ptr<StatePack> real_;
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
    days.push_back(rough_day(static_cast<std::uint64_t>(i), kind.seen));
  }
  if (!together.front()->pack()) GTEST_SKIP() << "no pack on this processor";
  const auto states = std::make_shared<Counting>(pack_of(together.front()->state()));
  FilterTrackerPack pack(states);
  std::vector<TrackerPack::Lane> lanes(kPackLanes);
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
    pack.step(lanes);
    for (std::size_t i = 0; i < lanes.size(); ++i) {
      if (!lanes[i].measurement) {
        EXPECT_TRUE(lanes[i].records.empty());
        continue;
      }
      const std::span<const StepRecord> own = alone[i]->step(days[i][k]);
      ASSERT_EQ(lanes[i].records.size(), own.size()) << "lane " << i << " step " << k;
      if (own.empty()) continue;
      expect_same(lanes[i].records[0], own[0]);
      if (HasFailure()) {
        ADD_FAILURE() << "lane " << i << " step " << k;
        return;
      }
    }
  }
  EXPECT_GT(states->kept, 600) << "a day may be rough, but most steps are ordinary";
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

// More trackers than lanes, in other places every time, some left out, some stepped alone or handed a state in between,
// and two packs that take turns: each comes to what it does alone.
TEST(FilterTrackerPack, TrackersMayComeAndGo) {
  constexpr std::size_t kTrackers = 11;
  std::vector<std::unique_ptr<FilterTracker>> together, alone;
  std::vector<std::vector<Measurement>> days;
  for (std::size_t i = 0; i < kTrackers; ++i) {
    together.push_back(kKinds[1].make());
    alone.push_back(kKinds[1].make());
    days.push_back(rough_day(20 + i, Seen::as_position));
  }
  if (!together.front()->pack()) GTEST_SKIP() << "no pack on this processor";
  const auto first = std::make_shared<Counting>(pack_of(together.front()->state()));
  const auto second = std::make_shared<Counting>(pack_of(together.front()->state()));
  FilterTrackerPack packs[] = {FilterTrackerPack(first), FilterTrackerPack(second)};
  for (std::size_t k = 0; k < 150; ++k) {
    std::vector<TrackerPack::Lane> lanes;
    std::vector<std::size_t> who;
    for (std::size_t j = 0; j < kTrackers; ++j) {
      const std::size_t i = (j + k) % kTrackers;
      if ((i + k) % 5 == 0) continue;  // left out, and stepped below
      lanes.push_back({together[i].get(), &days[i][k]});
      who.push_back(i);
    }
    packs[k / 20 % 2].step(lanes);
    for (std::size_t j = 0; j < lanes.size(); ++j) {
      const std::span<const StepRecord> own = alone[who[j]]->step(days[who[j]][k]);
      ASSERT_EQ(lanes[j].records.size(), own.size());
      if (!own.empty()) expect_same(lanes[j].records[0], own[0]);
    }
    for (std::size_t i = 0; i < kTrackers; ++i) {
      if ((i + k) % 5 != 0) continue;
      const std::span<const StepRecord> a = together[i]->step(days[i][k]), b = alone[i]->step(days[i][k]);
      ASSERT_EQ(a.size(), b.size());
      if (!a.empty()) expect_same(a[0], b[0]);
    }
    if (k % 37 == 36) {
      const BoundedVector x = Eigen::Vector4d(5000.0, 2000.0, 10.0, 20.0);
      const BoundedMatrix P = 1e4 * Eigen::Matrix4d::Identity();
      together[4]->take_over(days[4][k].time_s, x, P);
      alone[4]->take_over(days[4][k].time_s, x, P);
    }
    ASSERT_FALSE(HasFailure()) << "step " << k;
  }
  EXPECT_GT(first->kept, 200);
  EXPECT_GT(second->kept, 200);
}

TEST(FilterTrackerPack, LeavesTargetsThatAreNowhereToTheirTrackers) {
  const auto made = [] {
    const BoundedMatrix P = Eigen::Vector4d(1e4, 1e4, 1e8, 1e8).asDiagonal().toDenseMatrix();
    return FilterTracker(plane_space(), constant_velocity(), positions(),
                         PriorStart{Eigen::Vector4d(9.9e6, 0.0, 9e4, 0.0), P});
  };
  FilterTracker a = made(), b = made(), alone = made();
  const std::unique_ptr<TrackerPack> pack = a.pack();
  if (!pack) GTEST_SKIP() << "no pack on this processor";
  int failed = 0;
  for (int k = 1; k <= 6; ++k) {
    Measurement measurement;
    measurement.time_s = 0.4 * k;
    measurement.z = Eigen::Vector2d(9.9e6 + 3.6e4 * k, 0.0);
    std::vector<TrackerPack::Lane> lanes{{&a, &measurement}, {&b, &measurement}};
    pack->step(lanes);
    const std::span<const StepRecord> own = alone.step(measurement);
    ASSERT_EQ(lanes[1].records.size(), own.size());
    if (own.empty()) continue;
    expect_same(lanes[1].records[0], own[0]);
    failed += own[0].status == StepStatus::failed ? 1 : 0;
  }
  EXPECT_GT(failed, 0);
}

// A tracker outlives the pack that it was stepped in.
TEST(FilterTrackerPack, TrackersGoOnWithoutIt) {
  const auto tracker = kKinds[0].make(), other = kKinds[0].make(), alone = kKinds[0].make();
  const std::vector<Measurement> day = rough_day(1, Seen::as_position);
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
