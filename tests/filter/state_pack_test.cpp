// SPDX-License-Identifier: Apache-2.0
#include "truebearing/filter/state_pack.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "tests/filter/bent_motion.hpp"
#include "tests/filter/same_in_pack.hpp"
#include "truebearing/core/constants.hpp"
#include "truebearing/core/random.hpp"
#include "truebearing/filter/filter_kinds.hpp"
#include "truebearing/filter/interacting_multiple_model.hpp"
#include "truebearing/measurement/cartesian_position.hpp"
#include "truebearing/measurement/position.hpp"
#include "truebearing/measurement/range_bearing.hpp"
#include "truebearing/measurement/range_bearing_elevation.hpp"
#include "truebearing/measurement/range_bearing_elevation_rate.hpp"
#include "truebearing/motion/constant_velocity.hpp"
#include "truebearing/motion/coordinated_turn.hpp"

namespace truebearing::state_pack_test {
namespace {

using truebearing::testing::Bent;

using Noise = DiscreteWhiteNoise;
using Taken = std::unique_ptr<AnyMeasurement>;

std::unique_ptr<TrackedState> multiple_model(int modes, bool bent) {
  InteractingMultipleModel::Modes made;
  made.push_back(state_of<KalmanFilter<4>>(ConstantVelocity<2, Noise>{{0.5}}));
  for (int i = 1; i < modes - (bent ? 1 : 0); ++i)
    made.push_back(state_of<KalmanFilter<4>>(CoordinatedTurn<Noise>{{2.0 + i}, 0.03 * (i - 2.5)}));
  if (bent) made.push_back(state_of<KalmanFilter<4>>(Bent{}));
  return std::make_unique<InteractingMultipleModel>(std::move(made), star_chain(modes, 0.05, 0.1, 0.6, 1.0));
}

Taken position(const Eigen::Vector2d& z) {
  return std::make_unique<ErasedMeasurement<CartesianPosition<2>>>(
      CartesianPosition<2>{(Eigen::Matrix2d() << 2500.0, 400.0, 400.0, 900.0).finished()}, z, true);
}
Taken range_and_bearing(const Eigen::Vector2d& z) {
  return std::make_unique<ErasedMeasurement<RangeBearing<>>>(
      RangeBearing<>{.site_m = Eigen::Vector2d(-500.0, 800.0), .sigma_range_m = 30.0, .sigma_bearing_rad = 0.01}, z);
}

// A pack, and in `own` the states that it must come to, each begun somewhere else.
struct Both {
  std::unique_ptr<StatePack> pack;
  std::array<std::unique_ptr<TrackedState>, kPackLanes> own;
  RandomStream random{{1, Role::evaluation, 0}, StreamId::test};

  explicit Both(const TrackedState& prototype) : pack(pack_of(prototype)) {
    const int n = prototype.size();
    for (int lane = 0; lane < kPackLanes; ++lane) {
      auto& state = own[static_cast<std::size_t>(lane)];
      state = prototype.fresh();
      const BoundedMatrix P = (BoundedVector::Constant(n, 400.0 + 10.0 * lane)).asDiagonal();
      BoundedVector x(n);
      for (int i = 0; i < n; ++i) x[i] = (i < n / 2 ? 3000.0 : 80.0) * (1.0 + 0.1 * random.normal());
      state->begin(x.data(), P.data());
      if (pack) pack->enter(lane, *state);
    }
  }

  TrackedState& state(int lane) { return *own[static_cast<std::size_t>(lane)]; }

  void expect_same_estimate(int lane) { truebearing::testing::expect_same_estimate(*pack, lane, state(lane)); }

  void predict(LaneMask lanes, const std::array<double, kPackLanes>& dt_s) {
    ASSERT_EQ(pack->predict(lanes, dt_s.data()), lanes);
    for (int lane = 0; lane < kPackLanes; ++lane) {
      if (!has_lane(lanes, lane)) continue;
      ASSERT_EQ(state(lane).predict(dt_s[static_cast<std::size_t>(lane)]), StepStatus::ok);
      expect_same_estimate(lane);
    }
  }

  void update(LaneMask lanes, const std::array<Taken, kPackLanes>& taken) {
    std::array<const AnyMeasurement*, kPackLanes> measurements{};
    for (std::size_t i = 0; i < taken.size(); ++i) measurements[i] = taken[i].get();
    ASSERT_EQ(pack->update(lanes, measurements.data()), lanes);
    for (int lane = 0; lane < kPackLanes; ++lane) {
      if (!has_lane(lanes, lane)) continue;
      StateUpdate mine;
      ASSERT_EQ(state(lane).update(*taken[static_cast<std::size_t>(lane)], mine), StepStatus::ok);
      truebearing::testing::expect_same_update(*pack, lane, state(lane), mine);
    }
    pack->keep(lanes);
  }

  std::array<Taken, kPackLanes> looks(Taken (*look)(const Eigen::Vector2d&), bool polar) {
    std::array<Taken, kPackLanes> taken;
    for (int lane = 0; lane < kPackLanes; ++lane) {
      const Eigen::Vector2d place =
          state(lane).x().head<2>() - (polar ? Eigen::Vector2d(-500.0, 800.0) : Eigen::Vector2d(0.0, 0.0));
      const Eigen::Vector2d seen = polar ? Eigen::Vector2d(place.norm(), std::atan2(place[0], place[1])) : place;
      const Eigen::Vector2d sigma = polar ? Eigen::Vector2d(30.0, 0.01) : Eigen::Vector2d(50.0, 30.0);
      taken[static_cast<std::size_t>(lane)] =
          look(seen + sigma.cwiseProduct(Eigen::Vector2d(random.normal(), random.normal())));
    }
    return taken;
  }
};

constexpr std::array<double, kPackLanes> all_after(double dt_s) {
  return {dt_s, dt_s, dt_s, dt_s, dt_s, dt_s, dt_s, dt_s};
}

void expect_the_states_own(const TrackedState& prototype, Taken (*look)(const Eigen::Vector2d&), bool polar) {
  Both both(prototype);
  if (!both.pack) GTEST_SKIP() << "no pack on this processor";
  for (int step = 0; step < 25; ++step) {
    std::array<double, kPackLanes> dt_s = all_after(step % 7 == 0 ? 2.5 : 1.0);
    if (step % 5 == 0)
      for (std::size_t lane = 0; lane < dt_s.size(); ++lane) dt_s[lane] += 0.1 * static_cast<double>(lane);
    const LaneMask lanes = step % 4 == 3 ? 0x5b : kAllLanes;  // the others stay where they are
    both.predict(lanes, dt_s);
    both.update(lanes, both.looks(look, polar));
    if (::testing::Test::HasFatalFailure()) return;
  }
  // And back: the states go on from what the lanes hold.
  for (int lane = 0; lane < kPackLanes; ++lane) {
    const std::unique_ptr<TrackedState> left = prototype.fresh();
    both.pack->leave(lane, *left);
    EXPECT_EQ(left->x(), both.state(lane).x());
    EXPECT_EQ(left->P(), both.state(lane).P());
    left->predict(1.7);
    both.state(lane).predict(1.7);
    EXPECT_EQ(left->x(), both.state(lane).x());
    EXPECT_EQ(left->P(), both.state(lane).P());
    if (left->mode_probabilities()) {
      EXPECT_EQ(*left->mode_probabilities(), *both.state(lane).mode_probabilities());
    }
  }
}

TEST(StatePack, LanesAreKalmanFilters) {
  expect_the_states_own(*state_of<KalmanFilter<4>>(ConstantVelocity<2, Noise>{{0.5}}), position, false);
  expect_the_states_own(*state_of<KalmanFilter<4>>(CoordinatedTurn<Noise>{{0.5}, 0.05}), range_and_bearing, true);
}

TEST(StatePack, LanesAreExtendedKalmanFilters) {
  expect_the_states_own(*state_of<KalmanFilter<4>>(Bent{}), range_and_bearing, true);
  expect_the_states_own(*state_of<KalmanFilter<4>>(Bent{}), position, false);
}

class StatePackOf : public ::testing::TestWithParam<int> {};

TEST_P(StatePackOf, LanesAreMultipleModels) {
  expect_the_states_own(*multiple_model(GetParam(), false), position, false);
  if (GetParam() > 2) expect_the_states_own(*multiple_model(GetParam(), true), range_and_bearing, true);
}

INSTANTIATE_TEST_SUITE_P(Modes, StatePackOf, ::testing::Values(2, 3, 4, 5, 6, 8, 9, 10),
                         [](const auto& count) { return std::to_string(count.param); });

// On the line and in space, by positions.
template <int N>
void expect_positions_of(std::unique_ptr<TrackedState> prototype) {
  constexpr int M = N / 2;
  using Sensor = CartesianPosition<M>;
  Both both(*prototype);
  if (!both.pack) GTEST_SKIP() << "no pack on this processor";
  for (int step = 0; step < 10; ++step) {
    both.predict(kAllLanes, all_after(1.0));
    std::array<Taken, kPackLanes> taken;
    for (int lane = 0; lane < kPackLanes; ++lane) {
      Eigen::Matrix<double, M, 1> z = both.state(lane).x().template head<M>();
      for (int m = 0; m < M; ++m) z[m] += 10.0 * both.random.normal();
      const Sensor sensor{(100.0 + lane) * Eigen::Matrix<double, M, M>::Identity()};
      taken[static_cast<std::size_t>(lane)] = std::make_unique<ErasedMeasurement<Sensor>>(sensor, z, true);
    }
    both.update(kAllLanes, taken);
    if (::testing::Test::HasFatalFailure()) return;
  }
}

TEST(StatePack, IsOfTheLineAndOfSpaceToo) {
  expect_positions_of<2>(state_of<KalmanFilter<2>>(ConstantVelocity<1, Noise>{{0.5}}));
  expect_positions_of<6>(state_of<KalmanFilter<6>>(ConstantVelocity<3, Noise>{{0.5}}));
}

// By three components and by four, the longest that there are.
template <typename Sensor>
void expect_looks_in_space(const Sensor& sensor) {
  Both both(*state_of<KalmanFilter<6>>(ConstantVelocity<3, Noise>{{0.5}}));
  if (!both.pack) GTEST_SKIP() << "no pack on this processor";
  for (int step = 0; step < 10; ++step) {
    both.predict(kAllLanes, all_after(1.0));
    std::array<Taken, kPackLanes> taken;
    for (int lane = 0; lane < kPackLanes; ++lane) {
      typename Sensor::Vector z = sensor.h(both.state(lane).x());
      for (int m = 0; m < Sensor::kMeasurements; ++m) z[m] += sensor.sigma[m] * both.random.normal();
      taken[static_cast<std::size_t>(lane)] = std::make_unique<ErasedMeasurement<Sensor>>(sensor, z);
    }
    both.update(kAllLanes, taken);
    if (::testing::Test::HasFatalFailure()) return;
  }
}

TEST(StatePack, LanesInSpaceAreSeenByRadars) {
  const Eigen::Vector3d site(-500.0, 800.0, 20.0);
  expect_looks_in_space(RangeBearingElevation<>{site, {30.0, 0.01, 0.01}});
  expect_looks_in_space(RangeBearingElevationRate<>{site, {1.0, -2.0, 0.0}, {30.0, 0.01, 0.01, 2.0}});
}

TEST(StatePack, IsOfKalmanFiltersInTheDefaultFormAndOfModelsOfThem) {
  EXPECT_FALSE(pack_of(*state_of<KalmanFilter<4, SquareRoot>>(ConstantVelocity<2, Noise>{{1.0}})));
  EXPECT_FALSE(pack_of(*state_of<UnscentedKalmanFilter<4>>(ConstantVelocity<2, Noise>{{1.0}})));
  InteractingMultipleModel::Modes modes;
  modes.push_back(state_of<KalmanFilter<4>>(ConstantVelocity<2, Noise>{{1.0}}));
  modes.push_back(state_of<UnscentedKalmanFilter<4>>(ConstantVelocity<2, Noise>{{1.0}}));
  EXPECT_FALSE(pack_of(InteractingMultipleModel(std::move(modes), star_chain(2, 0.1, 0.1, 1.0, 1.0))));
}

// One lane that goes wrong says so, and keeps what it held; the others do not notice.
TEST(StatePack, IsNotCertainOfWhatGoesWrong) {
  constexpr int kWrong = 3;
  constexpr LaneMask kOthers = without(kAllLanes, lane_bit(kWrong));
  for (const bool multiple : {false, true}) {
    const std::unique_ptr<TrackedState> prototype =
        multiple ? multiple_model(3, false) : state_of<KalmanFilter<4>>(ConstantVelocity<2, Noise>{{0.5}});
    Both both(*prototype);
    if (!both.pack) GTEST_SKIP() << "no pack on this processor";
    both.predict(kAllLanes, all_after(1.0));
    both.update(kAllLanes, both.looks(position, false));
    const BoundedVector x = both.state(kWrong).x();
    const BoundedMatrix P = both.state(kWrong).P();

    std::array<double, kPackLanes> dt_s = all_after(1.0);
    dt_s[kWrong] = kInfinity;
    EXPECT_EQ(both.pack->predict(kAllLanes, dt_s.data()), kOthers);
    for (const int wrong : {0, 1, 2}) {
      EXPECT_EQ(both.pack->predict(kAllLanes, all_after(1.0).data()), kAllLanes);
      std::array<Taken, kPackLanes> taken = both.looks(position, false);
      if (wrong == 0)  // no number
        taken[kWrong] = position(Eigen::Vector2d(kNaN, 0.0));
      if (wrong == 1)  // no covariance
        taken[kWrong] = std::make_unique<ErasedMeasurement<CartesianPosition<2>>>(
            CartesianPosition<2>{Eigen::Vector2d(100.0, -1.0).asDiagonal().toDenseMatrix()}, Eigen::Vector2d::Zero(),
            true);
      if (wrong == 2)  // another kind than the first lane's
        taken[kWrong] = range_and_bearing(Eigen::Vector2d(3000.0, 0.5));
      std::array<const AnyMeasurement*, kPackLanes> measurements{};
      for (std::size_t i = 0; i < taken.size(); ++i) measurements[i] = taken[i].get();
      EXPECT_EQ(both.pack->update(kAllLanes, measurements.data()), kOthers) << wrong;
      StateUpdate update;
      for (int lane = 0; lane < kPackLanes; ++lane) {
        if (lane == kWrong) continue;
        both.state(lane).predict(1.0);
        both.state(lane).update(*taken[static_cast<std::size_t>(lane)], update);
        both.expect_same_estimate(lane);
      }
      both.pack->keep(kOthers);
    }
    for (int lane = 0; lane < kPackLanes; ++lane) {
      const std::unique_ptr<TrackedState> left = prototype->fresh();
      both.pack->leave(lane, *left);
      EXPECT_EQ(left->x(), lane == kWrong ? x : BoundedVector(both.state(lane).x()));
      EXPECT_EQ(left->P(), lane == kWrong ? P : BoundedMatrix(both.state(lane).P()));
    }
  }
}

// Modes that are surely in two places: the S of both together has no second axis to speak of.
TEST(StatePack, SaysLikeAModelThatItsInnovationHasNoCovariance) {
  const std::unique_ptr<TrackedState> prototype = multiple_model(2, false);
  const std::unique_ptr<StatePack> pack = pack_of(*prototype);
  if (!pack) GTEST_SKIP() << "no pack on this processor";
  auto& model = static_cast<InteractingMultipleModel&>(*prototype);
  const Eigen::Matrix4d P = 1e-6 * Eigen::Matrix4d::Identity();
  for (const int mode : {0, 1}) {
    const Eigen::Vector4d x((mode == 0 ? 1.0 : -1.0) * 3.1e6, (mode == 0 ? 1.0 : -1.0) * 7.7e6, 0.0, 0.0);
    model.begin_mode(mode, x.data(), P.data());
  }
  model.believe(Eigen::Vector2d(0.5, 0.5));
  pack->enter(0, model);
  const double dt_s = 1e-3;
  const Taken seen = std::make_unique<ErasedMeasurement<CartesianPosition<2>>>(
      CartesianPosition<2>{1e-6 * Eigen::Matrix2d::Identity()}, Eigen::Vector2d(1.0, 2.0), true);
  const AnyMeasurement* measurement = seen.get();
  StateUpdate own, packed;
  const LaneMask predicted = pack->predict(1, &dt_s);
  const LaneMask certain = predicted ? pack->update(1, &measurement) : LaneMask{0};
  model.predict(dt_s);
  const StepStatus status = model.update(*seen, own);
  if (certain) pack->update_of(0, packed);
  const bool packed_is_good = certain && std::isfinite(packed.nis);
  EXPECT_EQ(status, StepStatus::failed);
  EXPECT_FALSE(packed_is_good) << packed.nis;
}

TEST(StatePack, TellsOfPlacesThatNoTargetIsAt) {
  const std::unique_ptr<TrackedState> prototype = state_of<KalmanFilter<4>>(ConstantVelocity<2, Noise>{{0.5}});
  const std::unique_ptr<StatePack> pack = pack_of(*prototype);
  if (!pack) GTEST_SKIP() << "no pack on this processor";
  const Eigen::Matrix4d P = 100.0 * Eigen::Matrix4d::Identity();
  for (const int lane : {0, 1, 2}) {
    const Eigen::Vector4d x(lane == 1 ? 9.9e6 : 0.0, 0.0, lane == 1 ? 2e5 : 0.0, 3e7);
    prototype->begin(x.data(), (lane == 2 ? 1e13 * P : P).eval().data());
    pack->enter(lane, *prototype);
  }
  EXPECT_EQ(pack->free_lane(), 3);
  EXPECT_EQ(pack->predict(7, all_after(0.1).data()), 7);
  EXPECT_EQ(pack->within(7, 2, 1e7), 3) << "one does not know where it is";
  EXPECT_EQ(pack->predict(7, all_after(1.0).data()), 7);
  EXPECT_EQ(pack->within(7, 2, 1e7), 0) << "velocities may be large, places not";
  pack->drop(1);
  EXPECT_EQ(pack->free_lane(), 1);
}

}  // namespace
}  // namespace truebearing::state_pack_test
