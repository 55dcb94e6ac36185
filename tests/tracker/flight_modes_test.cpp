// SPDX-License-Identifier: Apache-2.0
#include "truebearing/tracker/flight_modes.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "tests/support/statistics.hpp"
#include "truebearing/core/angle.hpp"

namespace truebearing::flight_modes_test {
namespace {

using Complex = std::complex<double>;
using Kind = FlightMode::Kind;
using testing::kMissProbability;

constexpr double kExact = 1e-12;

RandomStream stream(std::uint64_t run = 0) {
  return {{1, Role::evaluation, run}, StreamId::test};
}

PlanarFlight lively() {
  using D = Distribution;
  PlanarFlight flight;
  flight.speed_mps = {D::Kind::uniform, {150.0, 350.0}};
  flight.first_leg_s = D(D::Kind::uniform, {5.0, 20.0});
  flight.leg_s = {D::Kind::uniform, {5.0, 30.0}};
  flight.turn_s = {D::Kind::log_uniform, {8.0, 30.0}};
  flight.turn_rate_degps = {D::Kind::uniform, {1.0, 6.0}};
  flight.roll_in_s = 0.0;
  flight.acceleration_share = 0.4;
  flight.acceleration_s = {D::Kind::uniform, {8.0, 10.0}};
  flight.acceleration_mps2 = {D::Kind::uniform, {5.0, 30.0}};
  flight.lowest_speed_mps = 80.0;
  flight.highest_speed_mps = 500.0;
  return flight;
}

struct Target {
  Complex position = 0.0, velocity;
  double weight = 1.0;

  void take(const FlightStep& step) {
    const double speed = std::abs(velocity);
    position += (step.glide + step.drift / speed) * velocity;
    velocity *= step.turn * (1.0 + step.gain / speed);
    weight *= step.weight;
  }
};

TEST(FlightModes, TurnIsAnArcHoweverItIsCut) {
  const FlightModes modes(lively());
  RandomStream numbers = stream();
  const double rate = radians(5.0);
  const auto turning = [&] { return FlightMode{Kind::turn, 0.0, 1e6, rate}; };
  Target whole{0.0, Complex(200.0, 30.0)}, cut = whole;
  FlightMode once = turning(), often = turning();
  whole.take(modes.advance(7.0, 200.0, once, numbers));
  for (const double part_s : {1.0, 0.5, 2.5, 3.0}) cut.take(modes.advance(part_s, 200.0, often, numbers));
  EXPECT_NEAR(std::abs(whole.velocity - cut.velocity), 0.0, kExact * 200.0);
  EXPECT_NEAR(std::abs(whole.position - cut.position), 0.0, kExact * 1400.0);
  EXPECT_NEAR(std::arg(whole.velocity) - std::arg(Complex(200.0, 30.0)), 7.0 * rate, kExact * 10.0);
  const Complex centre = Complex(0.0, 1.0) * Complex(200.0, 30.0) / rate;
  EXPECT_NEAR(std::abs(whole.position - centre), std::abs(centre), kExact * 1e4);
}

TEST(FlightModes, RollInIsThatOfTheGeneratorHoweverItIsCut) {
  PlanarFlight flight = lively();
  flight.first_leg_s = 0.0;
  flight.leg_s = 1e6;
  flight.turn_s = 20.0;
  flight.turn_rate_degps = 4.0;
  flight.acceleration_share = 0.0;
  flight.roll_in_s = 3.0;
  flight.speed_mps = 200.0;
  for (const double duration_s : {20.0, 4.0}) {
    flight.turn_s = duration_s;
    RandomStream numbers = stream();
    const std::vector<double> times_s{0.0, 30.0};
    const Eigen::Matrix4Xd flown = flight.fly(times_s, numbers).states;
    const FlightModes modes(flight);
    for (const double part_s : {30.0, 1.0, 0.7}) {
      Target target{0.0, Complex(flown(2, 0), flown(3, 0))};
      FlightMode mode = modes.first(numbers);
      for (double left_s = 30.0; left_s > 1e-9; left_s -= part_s)
        target.take(modes.advance(std::min(part_s, left_s), 200.0, mode, numbers));
      // A side of its own, and integrals that are exact where the generator sums over .1 s.
      const Complex start(flown(2, 0), flown(3, 0)), end(flown(2, 1), flown(3, 1)), place(flown(0, 1), flown(1, 1));
      const double turned = std::abs(std::arg(end / start)), own = std::abs(std::arg(target.velocity / start));
      EXPECT_NEAR(own, turned, 0.02) << duration_s << " s in parts of " << part_s;
      EXPECT_NEAR(std::abs(target.position), std::abs(place), 20.0) << duration_s << " s in parts of " << part_s;
    }
  }
}

TEST(FlightModes, SpeedStaysAtItsLimit) {
  const FlightModes modes(lively());
  RandomStream numbers = stream();
  FlightMode braking{Kind::acceleration, 0.0, 1e6, -10.0};
  const FlightStep step = modes.advance(4.0, 100.0, braking, numbers);
  EXPECT_NEAR(step.gain, -20.0, kExact * 100.0) << "80 m/s are reached after 2 s";
  EXPECT_NEAR(step.drift.real(), -(0.5 * 20.0 * 2.0 + 20.0 * 2.0), kExact * 100.0);
  EXPECT_EQ(step.gain_slope, -1.0);
  EXPECT_NEAR(step.drift_slope.real(), -2.0, kExact);
  FlightMode speeding{Kind::acceleration, 0.0, 1e6, 10.0};
  EXPECT_EQ(modes.advance(4.0, 600.0, speeding, numbers).gain, 0.0) << "a speed beyond the limit is kept";
}

// Speed, course and distance after a minute: as the generator has them, whatever the steps and however eagerly legs
// end.
class FlightModesLaw : public ::testing::TestWithParam<double> {};

TEST_P(FlightModesLaw, IsTheGenerators) {
  constexpr std::size_t kFlights = 20000;
  const double steps = GetParam(), eagerness = steps > 1.0 ? 1.3 : 1.0;
  const FlightModes modes(lively(), eagerness);
  struct Sums {
    std::vector<double> value, weight;
  };
  Sums speed, course, distance, generated_speed, generated_course, generated_distance;
  const std::vector<double> times_s{0.0, 60.0};
  for (std::size_t run = 0; run < kFlights; ++run) {
    RandomStream numbers = stream(run);
    const Eigen::Matrix4Xd flown = lively().fly(times_s, numbers).states;
    const Complex before(flown(2, 0), flown(3, 0)), after(flown(2, 1), flown(3, 1));
    generated_speed.value.push_back(std::abs(after));
    generated_course.value.push_back(std::abs(std::arg(after / before)));
    generated_distance.value.push_back(std::hypot(flown(0, 1), flown(1, 1)));
    Target target{0.0, lively().speed_mps.draw(numbers)};
    FlightMode mode = modes.first(numbers);
    for (int k = 0; k < steps; ++k) target.take(modes.advance(60.0 / steps, std::abs(target.velocity), mode, numbers));
    speed.value.push_back(std::abs(target.velocity));
    course.value.push_back(std::abs(std::arg(target.velocity)));
    distance.value.push_back(std::abs(target.position));
    for (Sums* sums : {&speed, &course, &distance}) sums->weight.push_back(target.weight);
  }
  const auto agree = [&](const Sums& own, const Sums& generator) {
    std::vector<double> differences;
    const double mean = testing::moments(generator.value).mean;
    for (std::size_t i = 0; i < kFlights; ++i)
      differences.push_back(own.weight[i] * (own.value[i] - mean) - (generator.value[i] - mean));
    const testing::Moments difference = testing::moments(differences);
    return std::abs(difference.mean) < testing::mean_margin(std::sqrt(difference.variance), kFlights);
  };
  EXPECT_TRUE(agree(speed, generated_speed));
  EXPECT_TRUE(agree(course, generated_course));
  EXPECT_TRUE(agree(distance, generated_distance));
  for (double& value : speed.value) value += 10.0;
  EXPECT_FALSE(agree(speed, generated_speed)) << "the test sees no difference";
}

INSTANTIATE_TEST_SUITE_P(Steps, FlightModesLaw, ::testing::Values(1.0, 60.0));

TEST(FlightModes, FirstLegWithoutALengthOfItsOwnIsARestOfALeg) {
  PlanarFlight flight = lively();
  flight.first_leg_s.reset();
  flight.leg_s = 40.0;
  const FlightModes modes(flight);
  std::vector<int> ended(8);
  for (std::uint64_t run = 0; run < 8000; ++run) {
    RandomStream numbers = stream(run);
    FlightMode mode = modes.first(numbers);
    std::size_t k = 0;
    for (; mode.kind == Kind::first_leg; ++k) modes.advance(5.0, 200.0, mode, numbers);
    ++ended.at(k - 1);
  }
  EXPECT_TRUE(testing::counts_are_even(ended));
}

TEST(FlightModes, QuietFlightHasNoManoeuvre) {
  PlanarFlight flight = lively();
  flight.quiet_share = 1.0;
  const FlightModes modes(flight, 2.0);
  RandomStream numbers = stream();
  FlightMode mode = modes.first(numbers);
  const FlightStep step = modes.advance(1e5, 200.0, mode, numbers);
  EXPECT_EQ(step.turn, 1.0);
  EXPECT_EQ(step.glide, 1e5);
  EXPECT_EQ(step.weight, 1.0);
}

}  // namespace
}  // namespace truebearing::flight_modes_test
