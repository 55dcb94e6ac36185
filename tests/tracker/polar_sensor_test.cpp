// SPDX-License-Identifier: Apache-2.0
#include "truebearing/tracker/polar_sensor.hpp"

#include <gtest/gtest.h>

#include <array>
#include <vector>

#include "tests/support/statistics.hpp"
#include "truebearing/core/covariance.hpp"
#include "truebearing/core/random.hpp"
#include "truebearing/filter/kalman.hpp"
#include "truebearing/motion/constant_velocity.hpp"
#include "truebearing/tracker/filter_bank.hpp"
#include "truebearing/tracker/filter_tracker_of.hpp"

namespace truebearing::polar_sensor_test {
namespace {

using Motion = ConstantVelocity<2, DiscreteWhiteNoise>;

constexpr double kSigma_m = 50.0, kSigma_deg = 2.0, kRange_m = 1e5;
const Motion kMotion{{0.01}};
const ConvertedSensor kSensor{{.sigma = {kSigma_m, kSigma_deg* kPi / 180.0}}};
const PriorStart kPrior{Eigen::Vector4d(0.0, kRange_m, 0.0, 0.0), Eigen::Vector4d(1e8, 1e8, 400.0, 400.0).asDiagonal()};

// A bank of the same filter twice.
FilterBank bank() {
  std::vector<std::unique_ptr<AnySensor>> sensors;
  sensors.push_back(sensor_of(kSensor));
  const FilterBank::Hypothesis one{kPrior.x, kPrior.P};
  const AnyMotions motions{erased(kMotion)};
  return {plane_space(), make_filter_group(FilterKind::kalman, motions, {{}, {}}), std::move(sensors), {one, one}, 0.0};
}

// Errors at the end of 300 looks at a target that crosses 100 km off, where a converted measurement is a hundred times
// as good along the sight as across it.
struct Errors {
  std::vector<double> range_m;
  double nees = 0.0;  // of the last looks, summed
};

Errors errors_of(Tracker& tracker) {
  constexpr int kRuns = 100;
  Errors errors;
  for (std::uint64_t run = 0; run < kRuns; ++run) {
    RandomStream random({41, Role::evaluation, run}, StreamId::test);
    tracker.reset();
    for (int k = 0; k < 300; ++k) {
      const Eigen::Vector4d truth(-3000.0 + 20.0 * k, kRange_m, 20.0, 0.0);
      const Eigen::Vector2d z(truth.head<2>().norm() + kSigma_m * random.normal(),
                              std::atan2(truth[0], truth[1]) + kSensor.polar.sigma[1] * random.normal());
      const auto records = tracker.step({.time_s = double(k), .z = z, .sigma = {}, .sensor = {}});
      if (k < 299) continue;
      const BoundedVector error = records[0].x - truth;
      errors.range_m.push_back(records[0].x.head<2>().norm() - truth.head<2>().norm());
      errors.nees += mahalanobis_squared(records[0].P, error);
    }
  }
  return errors;
}

void expect_honest(const Errors& errors) {
  const testing::Moments range = testing::moments(errors.range_m);
  EXPECT_LT(std::abs(range.mean),
            0.1 * kSigma_m + testing::mean_margin(std::sqrt(range.variance), errors.range_m.size()));
  const double runs = static_cast<double>(errors.range_m.size());
  EXPECT_LT(errors.nees / runs, 4.6) << "four components; R lies a little too wide along the sight";
  EXPECT_GT(errors.nees / runs, 1.5);
}

TEST(ConvertedSensor, MayBelieveOneCovarianceEverywhere) {
  ConvertedSensor sensor = kSensor;
  sensor.position_sigma_m = 30.0;
  for (const double range_m : {100.0, kRange_m}) {
    const Measurement seen{.time_s = 0.0, .z = Eigen::Vector2d(range_m, 0.3), .sigma = {}, .sensor = {}};
    EXPECT_EQ(sensor.fix(seen).R, Eigen::Matrix2d(900.0 * Eigen::Matrix2d::Identity()));
    EXPECT_EQ(sensor.model(seen, {kPrior.x, kPrior.P}).R(), sensor.fix(seen).R);
    EXPECT_EQ(sensor.value(seen), kSensor.value(seen)) << "what is measured stays";
  }
}

TEST(ConvertedSensor, DoesNotLengthenRanges) {
  FilterTrackerOf<KalmanFilter<4>, Motion, ConvertedSensor> tracker(plane_space(), kMotion, kSensor, kPrior);
  expect_honest(errors_of(tracker));
}

TEST(ConvertedSensor, DoesNotLengthenRangesInABank) {
  FilterBank tracker = bank();
  expect_honest(errors_of(tracker));
}

TEST(ConvertedSensor, BelievesAMeasurementWhereNothingBetterIsKnown) {
  const Measurement measurement{.time_s = 0.0, .z = Eigen::Vector2d(1e4, 1.0), .sigma = {}, .sensor = {}};
  Prediction expected{Eigen::Vector4d(0.0, 1e4, 0.0, 0.0), 1e8 * Eigen::Matrix4d::Identity()};
  EXPECT_EQ(kSensor.model(measurement, expected).R(), kSensor.fix(measurement).R);
  expected.P *= 1e-6;
  EXPECT_EQ(kSensor.model(measurement, expected).R(),
            converted_covariance({0.0, 1e4}, kSigma_m, kSensor.polar.sigma[1]));
}

}  // namespace
}  // namespace truebearing::polar_sensor_test
