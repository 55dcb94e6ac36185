// SPDX-License-Identifier: Apache-2.0
#include "truebearing/measurement/log_polar.hpp"

#include <gtest/gtest.h>

#include "tests/support/jacobian.hpp"
#include "truebearing/core/angle.hpp"
#include "truebearing/core/random.hpp"

namespace truebearing::log_polar_test {
namespace {

constexpr double kAlgebra = 1e-12;
constexpr double kJacobian = 1e-6;

struct Sight {
  Eigen::Vector4d x;
  Eigen::Vector2d site_m, site_velocity_mps;
};

Sight random_sight(RandomStream& random) {
  Sight sight;
  sight.x = {random.normal() * 1e4, random.normal() * 1e4, random.normal() * 5.0, random.normal() * 5.0};
  sight.site_m = {random.normal() * 1e3, random.normal() * 1e3};
  sight.site_velocity_mps = {random.normal() * 5.0, random.normal() * 5.0};
  return sight;
}

TEST(LogPolar, NamesBearingRangeAndTheirRates) {
  // North of the sensor at 1 km; it crosses to the East at 3 m/s and opens at 2 m/s, seen from a sensor that moves.
  const Eigen::Vector4d x(10.0, 1020.0, 3.0 + 1.0, 2.0 - 1.0);
  const Eigen::Vector4d y = log_polar<double>(x, {10.0, 20.0}, {1.0, -1.0});
  EXPECT_NEAR(y(0), 0.0, kAlgebra);
  EXPECT_NEAR(y(1), std::log(1000.0), kAlgebra);
  EXPECT_NEAR(y(2), 3e-3, kAlgebra);
  EXPECT_NEAR(y(3), 2e-3, kAlgebra);
}

TEST(LogPolar, LeadsThereAndBack) {
  RandomStream random({34, Role::evaluation, 0}, StreamId::test);
  for (int trial = 0; trial < 100; ++trial) {
    const Sight sight = random_sight(random);
    const Eigen::Vector4d y = log_polar<double>(sight.x, sight.site_m, sight.site_velocity_mps);
    const Eigen::Vector4d x = from_log_polar<double>(y, sight.site_m, sight.site_velocity_mps);
    EXPECT_LT((x - sight.x).norm(), kAlgebra * sight.x.norm());
    const Eigen::Matrix4d G = log_polar_jacobian<double>(sight.x, sight.site_m, sight.site_velocity_mps);
    // In units of the range, so that the entries are of one size.
    const double range_m = std::exp(y(1));
    const Eigen::Vector4d scale(range_m, range_m, 1.0, 1.0);
    const Eigen::Matrix4d product =
        scale.cwiseInverse().asDiagonal() * from_log_polar_jacobian<double>(y) * G * scale.asDiagonal();
    EXPECT_LT((product - Eigen::Matrix4d::Identity()).norm(), 1e-10);
  }
}

TEST(LogPolar, HasTheJacobiansOfCentralDifferences) {
  RandomStream random({35, Role::evaluation, 0}, StreamId::test);
  for (int trial = 0; trial < 100; ++trial) {
    const Sight sight = random_sight(random);
    const auto& [at, site_m, site_velocity_mps] = sight;
    const Eigen::Vector4d y = log_polar<double>(at, site_m, site_velocity_mps);
    const double range_m = std::exp(y(1));
    const auto to = [&](const Eigen::Vector4d& x) {
      Eigen::Vector4d moved = log_polar<double>(x, sight.site_m, sight.site_velocity_mps);
      moved(0) = wrap_pi(moved(0) - y(0));
      return moved;
    };
    const auto from = [&](const Eigen::Vector4d& from_y) {
      return from_log_polar<double>(from_y, sight.site_m, sight.site_velocity_mps);
    };
    const Eigen::Vector4d step(1e-4 * range_m, 1e-4 * range_m, 1e-3, 1e-3), y_step(1e-4, 1e-4, 1e-7, 1e-7);
    const auto G = testing::central_differences(to, at, step);
    const auto J = testing::central_differences(from, y, y_step);
    const Eigen::Matrix4d exact_G = log_polar_jacobian<double>(at, site_m, site_velocity_mps);
    const Eigen::Matrix4d exact_J = from_log_polar_jacobian<double>(y);
    for (int i = 0; i < 4; ++i) {
      EXPECT_LT((exact_G.row(i) - G.row(i)).norm(), kJacobian * G.row(i).norm()) << i;
      EXPECT_LT((exact_J.row(i) - J.row(i)).norm(), kJacobian * J.row(i).norm()) << i;
    }
  }
}

}  // namespace
}  // namespace truebearing::log_polar_test
