// SPDX-License-Identifier: Apache-2.0
#include "truebearing/evaluation/foretelling.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "tests/support/error_message.hpp"
#include "truebearing/core/angle.hpp"
#include "truebearing/core/constants.hpp"
#include "truebearing/core/random.hpp"
#include "truebearing/filter/erased_motion.hpp"
#include "truebearing/filter/filter_kinds.hpp"
#include "truebearing/motion/constant_velocity.hpp"
#include "truebearing/tracker/filter_tracker.hpp"
#include "truebearing/tracker/polar_sensor.hpp"
#include "truebearing/tracker/position_sensor.hpp"
#include "truebearing/tracker/raw_tracker.hpp"

namespace truebearing::foretelling_test {
namespace {

using ::testing::AllOf;
using testing::error_message;
using ::testing::HasSubstr;

std::unique_ptr<Tracker> filter(double sigma_a_mps2) {
  return std::make_unique<FilterTracker>(
      plane_space(),
      make_filter_state(FilterKind::kalman, erased(ConstantVelocity<2, DiscreteWhiteNoise>{{sigma_a_mps2}})),
      sensor_of(PositionSensor<2>{{50.0, 50.0}}), TwoPointStart{}, FilterTrackerOptions{});
}

TrackerSet trackers(double first_mps2, double second_mps2) {
  Ensemble ensemble;
  ensemble.add("first", filter(first_mps2));
  ensemble.add("second", filter(second_mps2));
  TrackerSet set(std::move(ensemble));
  set.show_member("first");
  set.show_member("second");
  return set;
}

// A target on a straight line.
Recording recording(int steps = 400) {
  RandomStream random({11, Role::evaluation, 0}, StreamId::test);
  Recording log;
  log.measured = Measured::position(2).components;
  for (int k = 0; k < steps; ++k)
    log.measurements.push_back({.time_s = double(k),
                                .z = Eigen::Vector2d(100.0 * k + 50.0 * random.normal(), 50.0 * random.normal()),
                                .sigma = {},
                                .sensor = {}});
  return log;
}

TEST(Foretelling, TheFilterThatSuitsTheTargetForetellsBest) {
  for (const int steps : {1, 5}) {
    const Foretelling told = foretell(trackers(30.0, 0.1), recording(), steps);
    EXPECT_EQ(told.best, 1u);
    EXPECT_EQ(told.quantity, "position_m");
    EXPECT_GT(told.trackers[0].above_best.value, 3.0 * told.trackers[0].above_best.se);
    // No better than the measurement that is foretold.
    EXPECT_GT(told.trackers[1].rmse.value, 50.0);
    EXPECT_NEAR(static_cast<double>(told.foretold), 400.0 / steps, 3.0);
    EXPECT_THAT(foretelling_text(told), AllOf(HasSubstr("second foretells best"), HasSubstr("below first")));
    EXPECT_THAT(foretelling_text(told), HasSubstr(foretelling_verdict(told)));
  }
}

// Whatever the stretches' lengths: of 39 errors some have three and some four.
TEST(Foretelling, DifferencesAreThoseOfTheSquares) {
  const Foretelling told = foretell(trackers(30.0, 0.1), recording(41), 1);
  const Foretelling::Tracker &best = told.trackers[told.best], &other = told.trackers[1 - told.best];
  EXPECT_NEAR(other.above_best.value, std::pow(other.rmse.value, 2.0) - std::pow(best.rmse.value, 2.0), 1e-9);
  EXPECT_GT(other.above_best.se, 0.0);
  EXPECT_EQ(best.above_best.value, 0.0);
}

TEST(Foretelling, EqualTrackersForetellAlike) {
  EXPECT_THAT(foretelling_text(foretell(trackers(1.0, 1.0), recording(), 2)), HasSubstr("no difference can be told"));
}

// What is hidden leaves no trace: a wild value among the hidden moves its own error alone.
TEST(Foretelling, TrackersDoNotSeeWhatTheyForetell) {
  Recording log = recording(40);
  const Foretelling before = foretell(trackers(1.0, 5.0), log, 1);
  const double sum = std::pow(before.trackers[0].rmse.value, 2.0) * static_cast<double>(before.foretold);
  log.measurements[39].z[0] += 1e6;  // the last: nothing is foretold from it
  const Foretelling after = foretell(trackers(1.0, 5.0), log, 1);
  EXPECT_NEAR(std::pow(after.trackers[0].rmse.value, 2.0) * static_cast<double>(after.foretold), sum + 1e12, 1e9);
}

TEST(Foretelling, MissesAreDistancesOrAngles) {
  StepRecord record;
  record.space = &plane_space();
  record.x = Eigen::Vector4d(3000.0, 4000.0, 0.0, 0.0);
  Measurement measurement;
  std::string quantity;
  SensorSites sites;
  const auto of = [&](const std::vector<std::string>& components, const BoundedVector& z) {
    measurement.z = z;
    return miss(components, measurement, sites, record, quantity).value_or(-1.0);
  };
  EXPECT_NEAR(of({"east_m", "north_m"}, Eigen::Vector2d(3030.0, 4040.0)), 50.0, 1e-9);
  EXPECT_EQ(quantity, "position_m");
  const double bearing_rad = std::atan2(3000.0, 4000.0);
  EXPECT_NEAR(of({"range_m", "bearing_deg"}, Eigen::Vector2d(5030.0, bearing_rad + 0.008)), 50.0, 1e-9);
  EXPECT_NEAR(of({"bearing_deg"}, BoundedVector::Constant(1, bearing_rad - 2.0 * kPi + radians(0.5))), 0.5, 1e-9);
  EXPECT_EQ(quantity, "bearing_deg");
  measurement.sensor = SensorState{Eigen::Vector2d(3000.0, 0.0), Eigen::Vector2d::Zero()};
  EXPECT_NEAR(of({"range_m"}, BoundedVector::Constant(1, 4010.0)), 10.0, 1e-9);
  measurement.sensor.reset();
  record.space = &space_space();
  record.x.resize(6);
  record.x << 3000.0, 4000.0, 500.0, 0.0, 0.0, 0.0;
  const double elevation_rad = std::atan2(500.0, 5000.0), slant_m = std::hypot(5000.0, 500.0);
  EXPECT_NEAR(
      of({"range_m", "bearing_deg", "elevation_deg"}, Eigen::Vector3d(slant_m, bearing_rad, elevation_rad + 0.01)),
      0.01 * slant_m, 1e-9);
  // From a site below; and from a platform above it, or at its height where its own is not told.
  sites.site_m = {{0.0, 0.0, -200.0}};
  EXPECT_NEAR(of({"range_m"}, BoundedVector::Constant(1, std::hypot(5000.0, 700.0) + 3.0)), 3.0, 1e-9);
  measurement.sensor = SensorState{Eigen::Vector2d(3000.0, 0.0), Eigen::Vector2d::Zero(), kNaN};
  EXPECT_NEAR(of({"range_m"}, BoundedVector::Constant(1, std::hypot(4000.0, 700.0) + 3.0)), 3.0, 1e-9);
  measurement.sensor->up_m = 100.0;
  EXPECT_NEAR(of({"range_m"}, BoundedVector::Constant(1, std::hypot(4000.0, 400.0) + 3.0)), 3.0, 1e-9);
  record.space = &plane_space();
  EXPECT_EQ(of({"frequency_hz"}, BoundedVector::Constant(1, 300.0)), -1.0);
}

// Of sensors that take turns each is hidden in turn, and not one of them all the time.
TEST(Foretelling, EachSensorIsHiddenInTurn) {
  Recording log = recording();
  log.sources = {{"a", log.measured}, {"b", log.measured}};
  for (std::size_t k = 0; k < log.measurements.size(); ++k) log.measurements[k].source = static_cast<int>(k % 2);
  EXPECT_NEAR(static_cast<double>(foretell(trackers(30.0, 0.1), log, 1).foretold), 400.0, 3.0);
}

TEST(Foretelling, WhoHasNoEstimateWhereNothingIsShownIsLeftOut) {
  Ensemble ensemble;
  ensemble.add("filter", filter(1.0));
  ensemble.add(
      "raw", std::make_unique<RawTracker>(state_space_of_components({"east_m", "north_m"}), Eigen::Vector2d(1.0, 1.0)));
  TrackerSet set(std::move(ensemble));
  set.show_member("filter");
  set.show_member("raw");
  const Foretelling told = foretell(set, recording(), 1);
  ASSERT_EQ(told.trackers.size(), 1u);
  EXPECT_EQ(told.left_out, std::vector<std::string>{"raw"});
  EXPECT_THAT(foretelling_text(told), HasSubstr("raw: has no estimate"));
  EXPECT_EQ(foretelling_verdict(told), "") << "of one alone";
}

// A radar that stands apart: measured from the origin the filter would miss by a kilometre.
TEST(Foretelling, SeesFromTheSiteOfTheSensor) {
  const Eigen::Vector2d site_m(600.0, -800.0);
  Recording log = recording(60), radar = log;
  radar.measured = {"range_m", "bearing_deg"};
  for (Measurement& measurement : radar.measurements) {
    const Eigen::Vector2d sight = measurement.z - site_m;
    measurement.z = Eigen::Vector2d(sight.norm(), std::atan2(sight.x(), sight.y()));
  }
  const auto told = [&](const SensorSites& sites) {
    Ensemble ensemble;
    ensemble.add("filter",
                 std::make_unique<FilterTracker>(
                     plane_space(),
                     make_filter_state(FilterKind::kalman, erased(ConstantVelocity<2, DiscreteWhiteNoise>{{1.0}})),
                     sensor_of(ConvertedSensor{{{50.0, 0.05}, 1.0, site_m}}), TwoPointStart{}, FilterTrackerOptions{}));
    TrackerSet set(std::move(ensemble));
    set.show_member("filter");
    return foretell(set, radar, 1, sites).trackers[0].rmse.value;
  };
  EXPECT_LT(told({{{600.0, -800.0, 0.0}}}), 200.0);
  EXPECT_GT(told({}), 900.0);
}

TEST(Foretelling, ShortLogsAreRefused) {
  EXPECT_THAT(error_message([&] { foretell(trackers(1.0, 2.0), recording(5), 2); }),
              AllOf(HasSubstr("2 steps ahead"), HasSubstr("4 or more")));
}

}  // namespace
}  // namespace truebearing::foretelling_test
