// SPDX-License-Identifier: Apache-2.0
#include "truebearing/filter/packed_modes.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <utility>

#include "tests/filter/bent_motion.hpp"
#include "truebearing/core/constants.hpp"
#include "truebearing/core/random.hpp"
#include "truebearing/filter/filter_kinds.hpp"
#include "truebearing/filter/interacting_multiple_model.hpp"
#include "truebearing/filter/separate_modes.hpp"
#include "truebearing/measurement/bearing.hpp"
#include "truebearing/measurement/cartesian_position.hpp"
#include "truebearing/measurement/range_bearing.hpp"
#include "truebearing/motion/constant_velocity.hpp"
#include "truebearing/motion/coordinated_turn.hpp"

namespace truebearing::packed_modes_test {
namespace {

using truebearing::testing::Bent;

constexpr double kExact = 1e-12;

using Noise = DiscreteWhiteNoise;
const Eigen::Vector4d kX0(4000.0, -2500.0, 120.0, 60.0);
const Eigen::Matrix4d kP0 = Eigen::Vector4d(1e4, 1e4, 900.0, 900.0).asDiagonal();

// `count` modes: straight, a few turns, and one that is bent where `bent`.
ModeBank::Modes modes_of(int count, bool bent) {
  ModeBank::Modes modes;
  modes.push_back(state_of<KalmanFilter<4>>(ConstantVelocity<2, Noise>{{0.5}}));
  for (int i = 1; i < count - (bent ? 1 : 0); ++i)
    modes.push_back(state_of<KalmanFilter<4>>(CoordinatedTurn<Noise>{{2.0 + i}, 0.03 * (i - 2.5)}));
  if (bent) modes.push_back(state_of<KalmanFilter<4>>(Bent{}));
  return modes;
}

ModeMatrix mixing_of(int count) {
  ModeMatrix weights = ModeMatrix::Constant(count, count, 0.2 / (count - 1));
  weights.diagonal().setConstant(0.8);
  if (count > 2) weights.col(1) = ModeVector::Unit(count, 1);
  return weights;
}

void expect_same(const ModeBank& packed, const ModeBank& separate, int count) {
  for (int j = 0; j < count; ++j) {
    const TrackedState& a = *packed.modes()[static_cast<std::size_t>(j)];
    const TrackedState& b = *separate.modes()[static_cast<std::size_t>(j)];
    EXPECT_LE((a.x() - b.x()).norm(), kExact * b.x().norm()) << "mode " << j;
    EXPECT_LE((a.P() - b.P()).norm(), kExact * b.P().norm()) << "mode " << j;
  }
}

// Both banks through the same steps: each mode, and what is made of all, are the same.
template <typename MeasurementAt>
void run_both(int count, bool bent, const MeasurementAt& measurement_at) {
  const std::unique_ptr<ModeBank> packed = packed_modes(modes_of(count, bent));
  SeparateModes separate(modes_of(count, bent));
  ASSERT_TRUE(packed);
  packed->begin(kX0.data(), kP0.data(), 4);
  separate.begin(kX0.data(), kP0.data(), 4);
  const ModeVector weights = ModeVector::LinSpaced(count, 1.0, count) / (0.5 * count * (count + 1));
  for (int step = 0; step < 30; ++step) {
    const double dt_s = step % 7 == 0 ? 2.5 : 1.0;
    ASSERT_TRUE(packed->mix_and_predict(mixing_of(count), dt_s));
    ASSERT_TRUE(separate.mix_and_predict(mixing_of(count), dt_s));
    const auto measurement = measurement_at(step, separate.modes().front()->x());
    ModeVector a, b;
    packed->update(*measurement, a);
    separate.update(*measurement, b);
    for (int j = 0; j < count; ++j) EXPECT_NEAR(a[j], b[j], kExact * std::abs(b[j]));
    BoundedVector nu_a, nu_b;
    BoundedMatrix S_a, S_b, K_a, K_b, P_a(4, 4), P_b(4, 4);
    packed->mix_innovations(weights, nu_a, S_a);
    separate.mix_innovations(weights, nu_b, S_b);
    EXPECT_LE((nu_a - nu_b).norm(), 1e-9);
    EXPECT_LE((S_a - S_b).norm(), kExact * S_b.norm());
    packed->keep();
    separate.keep();
    packed->mix_gains(weights, K_a);
    separate.mix_gains(weights, K_b);
    EXPECT_LE((K_a - K_b).norm(), kExact * K_b.norm());
    Eigen::Vector4d x_a, x_b;
    packed->mix(weights, x_a.data(), P_a.data());
    separate.mix(weights, x_b.data(), P_b.data());
    EXPECT_LE((x_a - x_b).norm(), kExact * x_b.norm());
    EXPECT_LE((P_a - P_b).norm(), kExact * P_b.norm());
    expect_same(*packed, separate, count);
  }
}

class PackedModesOf : public ::testing::TestWithParam<int> {};

TEST_P(PackedModesOf, AreTheSeparateOnesByPositions) {
  RandomStream random({1, Role::evaluation, 0}, StreamId::test);
  const CartesianPosition<2> sensor{2500.0 * Eigen::Matrix2d::Identity()};
  run_both(GetParam(), false, [&](int, const auto& x) {
    const Eigen::Vector2d z = x.template head<2>() + 50.0 * Eigen::Vector2d(random.normal(), random.normal());
    return std::make_unique<ErasedMeasurement<CartesianPosition<2>>>(sensor, z, true);
  });
}

TEST_P(PackedModesOf, AreTheSeparateOnesByRangeAndBearing) {
  RandomStream random({1, Role::evaluation, 1}, StreamId::test);
  const RangeBearing<> sensor{
      .site_m = Eigen::Vector2d(-500.0, 800.0), .sigma_range_m = 30.0, .sigma_bearing_rad = 0.01};
  run_both(GetParam(), true, [&](int, const auto& x) {
    const Eigen::Vector2d z = sensor.h(x) + Eigen::Vector2d(30.0 * random.normal(), 0.01 * random.normal());
    return std::make_unique<ErasedMeasurement<RangeBearing<>>>(sensor, z);
  });
}

INSTANTIATE_TEST_SUITE_P(Counts, PackedModesOf, ::testing::Values(2, 4, 6, 9, 10),
                         [](const auto& count) { return "Modes" + std::to_string(count.param); });

// Sensors that take turns, of other kinds and lengths, each as good as it says this time; intervals too.
TEST_P(PackedModesOf, AreToldEveryMeasurementAnew) {
  RandomStream random({1, Role::evaluation, 2}, StreamId::test);
  run_both(GetParam(), true, [&](int step, const auto& x) -> std::unique_ptr<AnyMeasurement> {
    const Eigen::Vector2d site(-500.0, 800.0 + step);
    const double sigma_m = 30.0 + 5.0 * (step % 3), sigma_rad = 0.01 + 0.002 * (step % 2);
    const Eigen::Vector2d noise_m = sigma_m * Eigen::Vector2d(random.normal(), random.normal());
    const CartesianPosition<2> position{Eigen::Vector2d(sigma_m * sigma_m, 900.0).asDiagonal().toDenseMatrix()};
    const RangeBearing<> polar{.site_m = site, .sigma_range_m = sigma_m, .sigma_bearing_rad = sigma_rad};
    const Bearing<> bearing{site, Eigen::Vector2d::Zero(), sigma_rad};
    switch (step * 7 % 5) {
      case 0:
        return std::make_unique<ErasedMeasurement<Bearing<>>>(bearing, bearing.h(x));
      case 1:
      case 2:
        return std::make_unique<ErasedMeasurement<RangeBearing<>>>(
            polar, polar.h(x) + Eigen::Vector2d(noise_m[0], sigma_rad * random.normal()));
      default:
        return std::make_unique<ErasedMeasurement<CartesianPosition<2>>>(position, x.template head<2>() + noise_m,
                                                                         true);
    }
  });
}

// The last one stands in several lanes.
TEST_P(PackedModesOf, MayBeginApartAndBeCopied) {
  const std::unique_ptr<ModeBank> packed = packed_modes(modes_of(GetParam(), true));
  SeparateModes separate(modes_of(GetParam(), true));
  for (int mode = 0; mode < GetParam(); ++mode) {
    const Eigen::Vector4d x = (1.0 + 0.1 * mode) * kX0;
    const Eigen::Matrix4d P = (1.0 + 0.2 * mode) * kP0;
    packed->begin_mode(mode, x.data(), P.data());
    separate.begin_mode(mode, x.data(), P.data());
  }
  expect_same(*packed, separate, GetParam());
  const std::unique_ptr<ModeBank> copy = packed->fresh();
  copy->assign(*packed);
  ASSERT_TRUE(separate.mix_and_predict(mixing_of(GetParam()), 1.5));
  for (ModeBank* bank : {packed.get(), copy.get()}) {
    ASSERT_TRUE(bank->mix_and_predict(mixing_of(GetParam()), 1.5));
    expect_same(*bank, separate, GetParam());
  }
}

TEST(PackedModes, AreThoseOfOneKindAndLength) {
  EXPECT_TRUE(packed_modes(modes_of(3, true)));
  ModeBank::Modes mixed = modes_of(3, false);
  mixed[1] = state_of<UnscentedKalmanFilter<4>>(ConstantVelocity<2, Noise>{{1.0}});
  EXPECT_FALSE(packed_modes(mixed));
  ModeBank::Modes form = modes_of(3, false);
  form[2] = state_of<KalmanFilter<4, SquareRoot>>(ConstantVelocity<2, Noise>{{1.0}});
  EXPECT_FALSE(packed_modes(form));
  EXPECT_FALSE(packed_modes(modes_of(1, false)));
}

// What fails in one mode is that mode's; of a prediction it leaves all as they were.
TEST(PackedModes, FailWhereSeparateOnesDo) {
  const std::unique_ptr<ModeBank> packed = packed_modes(modes_of(6, false));
  packed->begin(kX0.data(), kP0.data(), 4);
  EXPECT_FALSE(packed->mix_and_predict(mixing_of(6), kInfinity));
  for (const auto& mode : packed->modes()) EXPECT_EQ(mode->x(), kX0);
  EXPECT_TRUE(packed->mix_and_predict(mixing_of(6), 1.0));
  ModeVector gained;
  const CartesianPosition<2> no_covariance{Eigen::Vector2d(100.0, -1.0).asDiagonal().toDenseMatrix()};
  packed->update(ErasedMeasurement<CartesianPosition<2>>(no_covariance, kX0.head<2>(), true), gained);
  EXPECT_EQ(gained, ModeVector::Constant(6, -kInfinity));
  const CartesianPosition<2> sensor{2500.0 * Eigen::Matrix2d::Identity()};
  packed->update(ErasedMeasurement<CartesianPosition<2>>(sensor, Eigen::Vector2d(kNaN, 0.0), true), gained);
  EXPECT_EQ(gained, ModeVector::Constant(6, -kInfinity));
}

// Of a motion that goes nowhere from some states, though its F is known there.
struct Rooted : Bent {
  Eigen::Vector4d f(const State& x, double dt_s) const {
    State moved = Bent::f(x, dt_s);
    moved[2] = std::sqrt(x[2]);
    return moved;
  }
};

TEST(PackedModes, FailWhereAMotionComesToNoNumber) {
  const auto crosses = [](double speed_mps) {
    const auto modes = [] {
      ModeBank::Modes both = modes_of(2, false);
      both.push_back(state_of<KalmanFilter<4>>(Rooted{}));
      return both;
    };
    const std::unique_ptr<ModeBank> packed = packed_modes(modes());
    SeparateModes separate(modes());
    const Eigen::Vector4d x(0.0, 0.0, speed_mps, 0.0);
    packed->begin(x.data(), kP0.data(), 4);
    separate.begin(x.data(), kP0.data(), 4);
    const bool crossed = packed->mix_and_predict(mixing_of(3), 1.0);
    EXPECT_EQ(separate.mix_and_predict(mixing_of(3), 1.0), crossed);
    return crossed;
  };
  EXPECT_TRUE(crosses(100.0));
  EXPECT_FALSE(crosses(-100.0));
}

// An exact position that one mode is as sure of, and cannot take; the other can.
TEST(PackedModes, OneThatFailsStaysWhereItWasPredicted) {
  const auto two = [] {
    ModeBank::Modes modes;
    modes.push_back(state_of<KalmanFilter<4>>(ConstantVelocity<2, Noise>{{0.0}}));
    modes.push_back(state_of<KalmanFilter<4>>(ConstantVelocity<2, Noise>{{5.0}}));
    return modes;
  };
  const std::unique_ptr<ModeBank> packed = packed_modes(two());
  SeparateModes separate(two());
  const CartesianPosition<2> exact{Eigen::Matrix2d::Zero()};
  const Eigen::Vector2d z = kX0.head<2>() + kX0.tail<2>() + Eigen::Vector2d(1.0, 2.0);
  const Eigen::Matrix4d none = Eigen::Matrix4d::Zero();
  const ModeMatrix apart = ModeMatrix::Identity(2, 2);
  for (ModeBank* bank : {packed.get(), static_cast<ModeBank*>(&separate)}) {
    bank->begin(kX0.data(), none.data(), 4);
    ASSERT_TRUE(bank->mix_and_predict(apart, 1.0));
    ModeVector gained;
    bank->update(ErasedMeasurement<CartesianPosition<2>>(exact, z, true), gained);
    EXPECT_EQ(gained[0], -kInfinity);
    EXPECT_TRUE(std::isfinite(gained[1]));
    bank->keep();
    Eigen::Vector4d x;
    Eigen::Matrix4d P;
    bank->mix(ModeVector::Unit(2, 1), x.data(), P.data());
    EXPECT_TRUE(x.allFinite() && P.allFinite());
  }
  expect_same(*packed, separate, 2);
  EXPECT_TRUE(packed->mix_and_predict(mixing_of(2), 1.0));
  EXPECT_TRUE(separate.mix_and_predict(mixing_of(2), 1.0));
  expect_same(*packed, separate, 2);
}

}  // namespace
}  // namespace truebearing::packed_modes_test
