// SPDX-License-Identifier: Apache-2.0
#include "truebearing/simulation/flight_intervals.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <vector>

#include "tests/support/error_message.hpp"
#include "tests/support/statistics.hpp"
#include "truebearing/simulation/planar_flight_scenario.hpp"

namespace truebearing::flight_intervals_test {
namespace {

using testing::error_message;
using ::testing::HasSubstr;
using testing::mean_margin;
using testing::moments;

struct Flown {
  Eigen::Matrix4Xd states;
  double end_s = 0.0;
};

// Northwards at 50 m/s, looked at twice a second.
Flown fly(const FlightIntervals& intervals, int samples = 40) {
  RandomStream stream({1, Role::evaluation, 0}, StreamId::scenario);
  std::vector<double> times_s;
  for (int k = 0; k < samples; ++k) times_s.push_back(0.5 * k);
  Flown flown;
  flown.states = intervals.fly(times_s, {0.0, 50.0}, stream, flown.end_s);
  return flown;
}

TEST(FlightIntervals, AnAccelerationAlongTheVelocityIsAParabola) {
  FlightIntervals intervals{3.0, 4.0, 2.0, 0.0};
  const Flown flown = fly(intervals);
  EXPECT_EQ(flown.end_s, 12.0);
  for (int k = 0; k < 40; ++k) {
    const double t = std::min(0.5 * k, 12.0), after = 0.5 * k - t;
    const double north = 50.0 * t + t * t + after * (50.0 + 2.0 * 12.0);
    EXPECT_TRUE(flown.states.col(k).isApprox(Eigen::Vector4d(0.0, north, 0.0, 50.0 + 2.0 * t), 1e-12)) << k;
  }
}

TEST(FlightIntervals, AnAccelerationAcrossIsAimedOnceForEachHold) {
  const Flown flown = fly(FlightIntervals{1.0, 10.0, 0.0, 10.0});
  EXPECT_TRUE(flown.states.col(1).isApprox(Eigen::Vector4d(1.25, 25.0, 5.0, 50.0), 1e-12)) << "to starboard";
  EXPECT_TRUE(flown.states.col(2).isApprox(Eigen::Vector4d(5.0, 50.0, 10.0, 50.0), 1e-12));
  const Eigen::Vector2d aimed = Eigen::Vector2d(50.0, -10.0).normalized() * 10.0;
  EXPECT_TRUE(flown.states.col(4).tail<2>().isApprox(Eigen::Vector2d(10.0, 50.0) + aimed, 1e-12));

  FlightIntervals longer{1.0, 10.0, 0.0, 10.0, 5.0};
  EXPECT_TRUE(fly(longer).states.col(10).tail<2>().isApprox(Eigen::Vector2d(50.0, 50.0), 1e-12));
}

PlanarFlightParameters family() {
  PlanarFlightParameters parameters;
  parameters.steps = 49;
  parameters.flight.speed_mps = 60.0;
  const auto choice = [](std::vector<double> values) { return Distribution(Distribution::Kind::choice, values); };
  parameters.flight.intervals = FlightIntervals{choice({4, 5, 6}), choice({5, 6, 7, 8}),
                                                Distribution(Distribution::Kind::normal, {0.0, 2.0}), 0.0};
  parameters.site = SiteFromStart{Distribution(Distribution::Kind::uniform, {-600.0, 600.0}), -200.0};
  return parameters;
}

TEST(FlightIntervals, AScenarioEndsWithItsFlight) {
  const PlanarFlightScenario scenario(family());
  std::vector<double> east_m, speed_change_mps;
  std::set<std::size_t> lengths;
  for (std::uint64_t run = 0; run < 2000; ++run) {
    const Recording recording = scenario.simulate({3, Role::evaluation, run});
    const std::vector<BoundedVector>& x = recording.truth[0].x;
    lengths.insert(x.size());
    east_m.push_back(x[0](0));
    EXPECT_EQ(x[0](1), -200.0);
    speed_change_mps.push_back(x[1].tail<2>().norm() - 60.0);
  }
  EXPECT_EQ(*lengths.begin(), 1u + 4 * 5);
  EXPECT_LE(*lengths.rbegin(), 1u + 6 * 8);
  EXPECT_GT(*lengths.rbegin(), 1u + 5 * 8) << "the sixth interval";
  EXPECT_LT(std::abs(moments(east_m).mean), mean_margin(1200.0 / std::sqrt(12.0), east_m.size()));
  EXPECT_TRUE(testing::variance_fits(moments(speed_change_mps).variance, 4.0, speed_change_mps.size()));
}

// A recorder keeps positions from before the first look on, which then comes after the end of a flight as short.
TEST(FlightIntervals, AFlightThatEndsBeforeItsFirstLookIsLookedAtOnce) {
  PlanarFlightParameters parameters = family();
  parameters.flight.intervals = FlightIntervals{1.0, 0.1, 0.0, 0.0};
  parameters.jitter = RecorderJitter{};
  const Recording recording = PlanarFlightScenario(parameters).simulate({3, Role::evaluation, 0});
  EXPECT_EQ(recording.measurements.size(), 1u);
  EXPECT_TRUE(recording.truth[0].x[0].allFinite());
}

TEST(FlightIntervals, LooksAfterTheEndAreNone) {
  PlanarFlightParameters parameters = family();
  parameters.flight.intervals->count = 1.0;
  parameters.flight.intervals->interval_s = 5.0;
  parameters.looks.period_factor = 2.0;
  parameters.site = SiteAtRange{1000.0, 49};
  const Recording recording = PlanarFlightScenario(parameters).simulate({});
  EXPECT_EQ(recording.measurements.size(), 3u) << "at 0, 2 and 4 s";
  EXPECT_NEAR(recording.truth[0].x[2].head<2>().norm(), 1000.0, 1e-9) << "the last, where the flight ends before";
}

TEST(FlightIntervals, KeysAreChecked) {
  const auto refusal = [](const std::string& flight, const std::string& site) {
    return error_message([&] {
      const SharedTable table = parse_toml("output = \"plane\"\nperiod_s = 1.0\nsteps = 9\nflight = {" + flight +
                                               "}\nsite = {" + site + "}\nsensor = { position_sigma_m = 1.0 }\n",
                                           "flight.toml");
      TableReader reader(table, "flight.toml");
      read_planar_flight_scenario(reader);
      reader.finish();
    });
  };
  const std::string flight = "speed_mps = 50.0, intervals = 3, interval_s = 5.0, along_mps2 = 0.0, across_mps2 = 1.0";
  const std::string site = "start_east_m = 100.0, start_north_m = 0.0";
  EXPECT_EQ(refusal(flight, site), "no error");
  EXPECT_THAT(refusal(flight + ", leg_s = 5.0", site), HasSubstr("flight.leg_s: is not a known key"));
  EXPECT_THAT(refusal("speed_mps = 50.0, intervals = 0", site), HasSubstr("flight.intervals"));
  EXPECT_THAT(refusal("speed_mps = 50.0, intervals = 3", site), HasSubstr("flight.interval_s: is missing"));
  EXPECT_THAT(refusal(flight, "start_east_m = 100.0"), HasSubstr("site.start_north_m: is missing"));
  EXPECT_THAT(refusal(flight, site + ", closest_m = 3.0"), HasSubstr("site.closest_m: is not a known key"));
}

}  // namespace
}  // namespace truebearing::flight_intervals_test
