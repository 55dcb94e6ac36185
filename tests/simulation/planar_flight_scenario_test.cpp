// SPDX-License-Identifier: Apache-2.0
#include "truebearing/simulation/planar_flight_scenario.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/support/error_message.hpp"
#include "tests/support/statistics.hpp"
#include "truebearing/core/angle.hpp"

namespace truebearing::planar_flight_scenario_test {
namespace {

using ::testing::AllOf;
using testing::error_message;
using ::testing::HasSubstr;
using testing::mean_margin;
using testing::moments;
using testing::variance_fits;

const RunKey kKey{1, Role::evaluation, 0};

PlanarFlightParameters flight_past_a_site() {
  PlanarFlightParameters parameters;
  parameters.sensor.output = &planar_output("range");
  parameters.period_s = 0.1;
  parameters.steps = 3000;
  parameters.flight.leg_s = 40.0;
  parameters.flight.turn_s = 30.0;
  parameters.site = SiteBesideTrack{3000.0};
  parameters.sensor.sigma_m = 150.0;
  return parameters;
}

std::string error_of(const std::string& text) {
  return error_message([&] {
    const SharedTable table = parse_toml(text, "flight.toml");
    TableReader reader(table, "flight.toml");
    read_planar_flight_scenario(reader);
    reader.finish();
  });
}

TEST(PlanarFlightScenario, RangeRateIsTheDerivativeOfRange) {
  const Recording recording = PlanarFlightScenario(flight_past_a_site()).simulate(kKey);
  EXPECT_EQ(recording.measured, std::vector<std::string>{"position_m"});
  EXPECT_EQ(recording.truth_space, &line_space());
  const std::vector<BoundedVector>& x = recording.truth[0].x;
  for (std::size_t k = 1; k + 1 < x.size(); ++k) EXPECT_NEAR((x[k + 1](0) - x[k - 1](0)) / 0.2, x[k](1), 0.05) << k;
  EXPECT_EQ(recording.measurements.front().time_s, 0.1);
  EXPECT_NEAR(recording.measurements.back().time_s, 300.0, 1e-9);
}

TEST(PlanarFlightScenario, RangeIsTheNormOfThePlane) {
  PlanarFlightParameters parameters = flight_past_a_site();
  parameters.jitter = RecorderJitter{{0.5, 0.5}, 1.0};
  const Recording range = PlanarFlightScenario(parameters).simulate(kKey);
  parameters.sensor.output = &planar_output("plane");
  const PlanarFlightScenario in_plane(parameters);
  const Recording plane = in_plane.simulate(kKey);
  EXPECT_EQ(plane.measured, (std::vector<std::string>{"east_m", "north_m"}));
  EXPECT_EQ(plane.truth_space, &plane_space());
  EXPECT_EQ(&in_plane.truth_space(), &plane_space());
  for (std::size_t k = 0; k < plane.truth[0].x.size(); ++k) {
    EXPECT_NEAR(plane.truth[0].x[k].head(2).norm(), range.truth[0].x[k](0), 1e-9);
    EXPECT_LE(std::abs(range.truth[0].x[k](1)), 100.0 + 1e-9);
  }
}

TEST(PlanarFlightScenario, MeasurementErrorIsGaussianOnTheRecordedPosition) {
  PlanarFlightParameters parameters = flight_past_a_site();
  parameters.steps = 10'000;
  parameters.jitter = RecorderJitter{{0.5, 0.5}, 2.0};
  for (const char* output : {"range", "plane"}) {
    parameters.sensor.output = &planar_output(output);
    const Recording recording = PlanarFlightScenario(parameters).simulate(kKey);
    for (Eigen::Index axis = 0; axis < recording.measurements[0].z.size(); ++axis) {
      std::vector<double> errors;
      for (std::size_t k = 0; k < recording.measurements.size(); ++k)
        errors.push_back(recording.measurements[k].z(axis) - recording.truth[0].x[k](axis));
      EXPECT_LT(std::abs(moments(errors).mean), mean_margin(150.0, errors.size()));
      EXPECT_TRUE(variance_fits(moments(errors).variance, 150.0 * 150.0, errors.size()));
    }
  }
}

TEST(PlanarFlightScenario, JitterMovesPositionsAndNotVelocities) {
  PlanarFlightParameters parameters = flight_past_a_site();
  parameters.sensor.output = &planar_output("plane");
  parameters.flight.leg_s = 1e6;
  parameters.jitter = RecorderJitter{{1.0}, 0.0};
  const Recording smooth = PlanarFlightScenario(parameters).simulate(kKey);
  parameters.jitter = RecorderJitter{{1.0}, 0.5};
  const Recording jittered = PlanarFlightScenario(parameters).simulate(kKey);
  std::vector<double> squared_m2;
  for (std::size_t k = 0; k < smooth.truth[0].x.size(); ++k) {
    const BoundedVector moved = jittered.truth[0].x[k] - smooth.truth[0].x[k];
    squared_m2.push_back(moved.head(2).squaredNorm());
    EXPECT_EQ(moved.tail(2).norm(), 0.0);
  }
  // 100 m/s for a Laplace time of deviation 0.5 s.
  EXPECT_NEAR(moments(squared_m2).mean, 2500.0, mean_margin(std::sqrt(5.0) * 2500.0, squared_m2.size()));
}

TEST(PlanarFlightScenario, SiteStandsOffTheTrackByTheDistanceDrawn) {
  PlanarFlightParameters parameters = flight_past_a_site();
  parameters.steps = 300;
  const auto closest_m = [&](std::uint64_t run) {
    const Recording recording = PlanarFlightScenario(parameters).simulate({1, Role::evaluation, run});
    double closest = 1e9;
    for (const BoundedVector& x : recording.truth[0].x) closest = std::min(closest, x(0));
    return closest;
  };
  parameters.flight.leg_s = 1e6;
  for (std::uint64_t run = 0; run < 50; ++run) EXPECT_NEAR(closest_m(run), 3000.0, 1e-6);

  parameters.site = SiteBesideTrack{3000.0, 0.3, 500.0};
  std::vector<double> overflights;
  for (std::uint64_t run = 0; run < 1000; ++run) overflights.push_back(closest_m(run) < 1000.0);
  EXPECT_NEAR(moments(overflights).mean, 0.3, mean_margin(std::sqrt(0.21), overflights.size()));

  parameters.flight.leg_s = 20.0;
  for (std::uint64_t run = 0; run < 50; ++run) EXPECT_LE(closest_m(run), 3000.0 + 1e-6);
}

TEST(PlanarFlightScenario, SigmaIsReportedWhereAsked) {
  PlanarFlightParameters parameters = flight_past_a_site();
  EXPECT_EQ(PlanarFlightScenario(parameters).simulate(kKey).measurements[0].sigma.size(), 0);
  parameters.sensor.reported = true;
  parameters.sensor.output = &planar_output("plane");
  EXPECT_EQ(PlanarFlightScenario(parameters).simulate(kKey).measurements[0].sigma, Eigen::Vector2d(150.0, 150.0));
}

TEST(PlanarFlightScenario, SiteAtRangeIsThatFarAtThatStep) {
  PlanarFlightParameters parameters = flight_past_a_site();
  parameters.steps = 100;
  parameters.sensor.output = &planar_output("range_bearing");
  parameters.sensor.sigma_m = 50.0;
  parameters.sensor.further_sigma = BoundedVector::Constant(1, 0.005);
  parameters.site = SiteAtRange{Distribution(Distribution::Kind::uniform, {8000.0, 30000.0}), 60};
  const PlanarFlightScenario scenario(parameters);
  for (std::uint64_t run = 0; run < 50; ++run) {
    const Recording recording = scenario.simulate({1, Role::evaluation, run});
    EXPECT_EQ(recording.measured, (std::vector<std::string>{"range_m", "bearing_deg"}));
    const BoundedVector& x = recording.truth[0].x[59];
    EXPECT_GE(x.head(2).norm(), 8000.0);
    EXPECT_LE(x.head(2).norm(), 30000.0);
    const BoundedVector& z = recording.measurements[59].z;
    EXPECT_LT(std::abs(z[0] - x.head(2).norm()), 5.0 * 50.0);
    EXPECT_LT(std::abs(wrap_pi(z[1] - std::atan2(x[0], x[1]))), 5.0 * 0.005);
  }
}

TEST(PlanarFlightScenario, OutliersAreAsRareAndAsLargeAsAsked) {
  PlanarFlightParameters parameters = flight_past_a_site();
  parameters.steps = 20000;
  parameters.sensor.output = &planar_output("plane");
  parameters.sensor.sigma_m = 10.0;
  parameters.sensor.outlier_share = 0.03;
  parameters.sensor.outlier_factor = 10.0;
  const Recording recording = PlanarFlightScenario(parameters).simulate(kKey);
  std::vector<double> squared;
  for (std::size_t k = 0; k < recording.measurements.size(); ++k)
    squared.push_back((recording.measurements[k].z - recording.truth[0].x[k].head(2)).squaredNorm());
  const testing::Moments found = moments(squared);
  EXPECT_NEAR(found.mean, 200.0 * (0.97 + 0.03 * 100.0), mean_margin(std::sqrt(found.variance), squared.size()));
}

TEST(PlanarFlightScenario, PhasesTellManoeuvresFromQuiet) {
  PlanarFlightParameters parameters = flight_past_a_site();
  parameters.period_s = 1.0;
  parameters.steps = 200;
  parameters.flight.first_leg_s = 20.0;
  parameters.flight.leg_s = 30.0;
  parameters.flight.turn_s = 10.0;
  parameters.quiet_after_s = 12.0;
  const Recording recording = PlanarFlightScenario(parameters).simulate(kKey);
  EXPECT_EQ(recording.phases, (std::vector<std::string>{"manoeuvre", "quiet"}));
  // Sample k is at k s of the flight: quiet to 20 s, turning to 30 s, quiet again from 42 s to 60 s, and so on.
  for (std::size_t k = 0; k < 200; ++k) {
    const bool quiet = k <= 20 || (k - 20) % 40 == 0 || (k - 20) % 40 > 22;
    EXPECT_EQ(recording.truth[0].phase[k], quiet ? 1 : 0) << k;
  }
}

TEST(PlanarFlightScenario, KeysAreChecked) {
  const std::string head = "output = \"range\"\nperiod_s = 5.0\nsteps = 10\n";
  const std::string flight = "[flight]\nspeed_mps = 100\nleg_s = 30\nturn_s = 30\nturn_rate_degps = 3\nroll_in_s = 3\n";
  const std::string site = "[site]\nclosest_m = 100\n";
  const std::string sensor = "[sensor]\nposition_sigma_m = 150\n";
  EXPECT_EQ(error_of(head + flight + site + sensor), "no error");
  EXPECT_THAT(error_of(head + flight + site + sensor + "[jitter]\nknots = [0.5, 0.4]\ntime_sigma_s = 1\n"),
              AllOf(HasSubstr("jitter.knots"), HasSubstr("does not sum to 1")));
  EXPECT_THAT(error_of(head + flight + site + "overflight_share = 0.3\n" + sensor),
              HasSubstr("site.overflight_m: is missing"));
  EXPECT_THAT(error_of(head + flight + "roll_out_s = 3\n" + site + sensor), HasSubstr("flight.roll_out_s"));
  EXPECT_THAT(error_of("output = \"bearing\"\n"), HasSubstr("plane, range, range_bearing"));
}

}  // namespace
}  // namespace truebearing::planar_flight_scenario_test
