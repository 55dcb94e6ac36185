// SPDX-License-Identifier: Apache-2.0
#include "truebearing/simulation/planar_flight.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "tests/support/statistics.hpp"
#include "truebearing/core/angle.hpp"

namespace truebearing::planar_flight_test {
namespace {

using testing::mean_margin;
using testing::moments;

RandomStream stream(std::uint64_t run = 0) {
  return {{1, Role::evaluation, run}, StreamId::scenario};
}

Eigen::Matrix4Xd fly(const PlanarFlight& flight, double period_s, int samples, std::uint64_t run = 0) {
  RandomStream numbers = stream(run);
  std::vector<double> times_s;
  for (int k = 0; k < samples; ++k) times_s.push_back(k * period_s);
  return flight.fly(times_s, numbers).states;
}

/// Course changes between samples, clockwise.
std::vector<double> turn_rates_degps(const Eigen::Matrix4Xd& track, double period_s) {
  std::vector<double> rates;
  for (Eigen::Index k = 1; k < track.cols(); ++k) {
    const auto course = [&](Eigen::Index i) { return std::atan2(track(2, i), track(3, i)); };
    rates.push_back(degrees(wrap_pi(course(k) - course(k - 1))) / period_s);
  }
  return rates;
}

TEST(PlanarFlight, LegIsStraight) {
  PlanarFlight flight;
  flight.leg_s = 1e6;
  const Eigen::Matrix4Xd track = fly(flight, 5.0, 100);
  EXPECT_EQ(track.col(0).head<2>(), Eigen::Vector2d::Zero());
  for (Eigen::Index k = 0; k < 100; ++k) {
    EXPECT_TRUE(track.col(k).tail<2>().isApprox(track.col(0).tail<2>(), 1e-12));
    EXPECT_TRUE(track.col(k).head<2>().isApprox(5.0 * static_cast<double>(k) * track.col(0).tail<2>(), 1e-9));
  }
  EXPECT_NEAR(track.col(0).tail<2>().norm(), 100.0, 1e-9);
}

// A straight way is flown in strides; a turn of no rate, sub-step by sub-step as any turn, comes to the same bits.
TEST(PlanarFlight, StraightLegIsFlownAsATurnOfNoRate) {
  for (const double period_s : {0.04, 0.1, 0.77, 5.0}) {
    PlanarFlight straight;
    straight.leg_s = 1e6;
    PlanarFlight turning = straight, mixed = straight;
    turning.leg_s = 0.1;
    turning.turn_s = 1e6;
    turning.turn_rate_degps = mixed.turn_rate_degps = 0.0;
    mixed.leg_s = 3.3;
    mixed.turn_s = 2.1;
    for (std::uint64_t run = 0; run < 5; ++run) {
      const Eigen::Matrix4Xd track = fly(straight, period_s, 100, run);
      EXPECT_EQ(fly(turning, period_s, 100, run), track) << period_s;
      EXPECT_EQ(fly(mixed, period_s, 100, run), track) << period_s;
    }
  }
}

TEST(PlanarFlight, TurnIsACircleWhateverThePeriod) {
  PlanarFlight flight;
  flight.leg_s = 0.1;
  flight.turn_s = 1e6;
  flight.roll_in_s = 0.0;
  flight.turn_rate_degps = 3.0;
  const double radius_m = 100.0 / radians(3.0);
  for (const double period_s : {0.05, 1.0, 5.0}) {
    const Eigen::Matrix4Xd track = fly(flight, period_s, 300);
    const Eigen::Vector4d begin = track.col(10);
    const double side = wrap_pi(std::atan2(track(2, 11), track(3, 11)) - std::atan2(begin(2), begin(3))) > 0 ? 1 : -1;
    const Eigen::Vector2d centre = begin.head<2>() + side * radius_m / 100.0 * Eigen::Vector2d(begin(3), -begin(2));
    for (Eigen::Index k = 10; k < 300; ++k) {
      EXPECT_NEAR((track.col(k).head<2>() - centre).norm(), radius_m, 1e-6) << period_s;
      EXPECT_NEAR(track.col(k).tail<2>().norm(), 100.0, 1e-9);
    }
  }
}

TEST(PlanarFlight, VelocityIsTheDerivativeOfPosition) {
  PlanarFlight flight;
  flight.leg_s = 10.0;
  flight.turn_s = 20.0;
  constexpr double kPeriod_s = 0.1;
  const Eigen::Matrix4Xd track = fly(flight, kPeriod_s, 2000);
  // A central difference is off by h^2/6 of the third derivative: speed (rate^2 + rate of the roll-in).
  const double bound = kPeriod_s * kPeriod_s * 100.0 * (std::pow(radians(3.0), 2) + radians(1.0));
  for (Eigen::Index k = 1; k + 1 < track.cols(); ++k) {
    const Eigen::Vector2d slope = (track.col(k + 1) - track.col(k - 1)).head<2>() / (2.0 * kPeriod_s);
    EXPECT_LT((slope - track.col(k).tail<2>()).norm(), bound) << k;
  }
}

TEST(PlanarFlight, RateRampsLinearlyAtBothEndsOfATurn) {
  PlanarFlight flight;
  flight.leg_s = 50.0;
  flight.turn_s = 20.0;
  flight.roll_in_s = 3.0;
  constexpr double kPeriod_s = 0.1;
  std::vector<double> rates = turn_rates_degps(fly(flight, kPeriod_s, 1300), kPeriod_s);
  for (double& rate : rates) rate = std::abs(rate);
  EXPECT_NEAR(*std::max_element(rates.begin(), rates.end()), 3.0, 1e-9);
  const auto begin = std::find_if(rates.begin(), rates.end(), [](double rate) { return rate > 1e-9; });
  const auto end = std::find_if(begin, rates.end(), [](double rate) { return rate < 1e-9; });
  EXPECT_NEAR(static_cast<double>(end - begin) * kPeriod_s, 20.0, 0.11);
  for (int i = 1; i < 29; ++i) {
    EXPECT_NEAR(begin[i] - begin[i - 1], 1.0 * kPeriod_s, 1e-9);
    EXPECT_NEAR(end[-i - 1] - end[-i], 1.0 * kPeriod_s, 1e-9);
  }
  double turned_deg = 0.0;
  for (auto rate = begin; rate != end; ++rate) turned_deg += *rate * kPeriod_s;
  EXPECT_NEAR(turned_deg, 3.0 * (20.0 - 3.0), 0.1);
}

TEST(PlanarFlight, LegsTurnsAndSidesAlternateAsDrawn) {
  PlanarFlight flight;
  flight.leg_s = 30.0;
  flight.turn_s = 20.0;
  flight.roll_in_s = 0.0;
  std::vector<double> lefts, turning;
  for (std::uint64_t run = 0; run < 400; ++run) {
    const std::vector<double> rates = turn_rates_degps(fly(flight, 1.0, 101, run), 1.0);
    lefts.push_back(*std::max_element(rates.begin(), rates.begin() + 50) < 1.0);
    // Over two whole cycles two fifths of the time are spent in turns, wherever the flight begins.
    for (const double rate : rates) turning.push_back(std::abs(rate) / 3.0);
  }
  EXPECT_NEAR(moments(lefts).mean, 0.5, mean_margin(0.5, lefts.size()));
  EXPECT_NEAR(moments(turning).mean, 0.4, 1e-9);
}

TEST(PlanarFlight, FirstCourseIsAnyCourse) {
  std::vector<int> counts(8);
  for (std::uint64_t run = 0; run < 4000; ++run) {
    const Eigen::Matrix4Xd track = fly({}, 1.0, 1, run);
    ++counts.at(static_cast<std::size_t>((std::atan2(track(2, 0), track(3, 0)) + kPi) / (2.0 * kPi) * 8.0));
  }
  EXPECT_TRUE(testing::counts_are_even(counts));
}

TEST(PlanarFlight, AccelerationsKeepTheCourseAndTheSpeedLimits) {
  PlanarFlight flight;
  flight.leg_s = 10.0;
  flight.roll_in_s = 0.0;
  flight.acceleration_share = 1.0;
  flight.acceleration_s = 20.0;
  flight.acceleration_mps2 = 10.0;
  flight.lowest_speed_mps = 50.0;
  flight.highest_speed_mps = 200.0;
  bool slowest = false, fastest = false;
  for (std::uint64_t run = 0; run < 20; ++run) {
    const Eigen::Matrix4Xd track = fly(flight, 1.0, 300, run);
    const Eigen::Vector2d course = track.col(0).tail<2>().normalized();
    for (Eigen::Index k = 0; k < track.cols(); ++k) {
      const double speed = track.col(k).tail<2>().norm();
      EXPECT_TRUE(track.col(k).tail<2>().isApprox(speed * course, 1e-9));
      EXPECT_GE(speed, 50.0 - 1e-9);
      EXPECT_LE(speed, 200.0 + 1e-9);
      slowest |= speed < 51.0;
      fastest |= speed > 199.0;
    }
    for (Eigen::Index k = 1; k + 1 < track.cols(); ++k)  // the position is the integral of the velocity
      EXPECT_LT((track.col(k + 1).head<2>() - track.col(k).head<2>() -
                 0.5 * (track.col(k + 1).tail<2>() + track.col(k).tail<2>()))
                    .norm(),
                2.6);
  }
  EXPECT_TRUE(slowest && fastest);
}

TEST(PlanarFlight, QuietFlightsHaveNoManoeuvre) {
  PlanarFlight flight;
  flight.leg_s = 10.0;
  flight.quiet_share = 0.2;
  std::vector<double> quiet;
  for (std::uint64_t run = 0; run < 1000; ++run) {
    const Eigen::Matrix4Xd track = fly(flight, 1.0, 60, run);
    quiet.push_back((track.col(59).tail<2>() - track.col(0).tail<2>()).norm() < 1e-9);
  }
  EXPECT_NEAR(moments(quiet).mean, 0.2, mean_margin(0.4, quiet.size()));
}

}  // namespace
}  // namespace truebearing::planar_flight_test
