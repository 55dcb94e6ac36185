// SPDX-License-Identifier: Apache-2.0
#include "truebearing/measurement/range_bearing.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "tests/support/jacobian.hpp"
#include "tests/support/statistics.hpp"
#include "truebearing/core/covariance.hpp"
#include "truebearing/core/random.hpp"

namespace truebearing::range_bearing_test {
namespace {

constexpr double kAlgebra = 1e-12;
constexpr double kJacobian = 1e-6;

TEST(RangeBearing, MeasuresClockwiseFromNorth) {
  const RangeBearing<> model{{100.0, 200.0}, 50.0, 0.01};
  EXPECT_TRUE(model.h({103.0, 204.0, 7.0, 8.0}).isApprox(Eigen::Vector2d(5.0, std::atan2(3.0, 4.0)), kAlgebra));
  EXPECT_TRUE(model.h({103.0, 200.0, 7.0, 8.0}).isApprox(Eigen::Vector2d(3.0, kPi / 2), kAlgebra));
  EXPECT_TRUE(model.R().isApprox(Eigen::Matrix2d(Eigen::Vector2d(2500.0, 1e-4).asDiagonal()), kAlgebra));
}

TEST(RangeBearing, HasTheJacobianOfCentralDifferences) {
  RandomStream random({22, Role::evaluation, 0}, StreamId::test);
  for (int trial = 0; trial < 100; ++trial) {
    const RangeBearing<> model{{random.normal() * 1e3, random.normal() * 1e3}, 1.0, 1.0};
    const Eigen::Vector4d x(random.normal() * 1e4, random.normal() * 1e4, random.normal() * 50, random.normal() * 50);
    const Eigen::Vector2d z = model.h(x);
    const Eigen::Vector4d step = Eigen::Vector4d::Constant(1e-4 * z(0));
    const auto from_z = [&](const Eigen::Vector4d& at) { return model.residual(model.h(at), z); };
    const Eigen::Matrix<double, 2, 4> expected = testing::central_differences(from_z, x, step);
    for (int i = 0; i < 2; ++i)
      EXPECT_LT((model.H(x).row(i) - expected.row(i)).norm(), kJacobian * expected.row(i).norm());
  }
}

TEST(RangeBearing, HasNoDirectionAtTheSite) {
  const RangeBearing<> model{{1.0, 2.0}, 10.0, 0.1};
  EXPECT_EQ(model.H({1.0, 2.0, 3.0, 4.0}), (Eigen::Matrix<double, 2, 4>::Zero()));
  EXPECT_EQ(model.h({1.0, 2.0, 3.0, 4.0})(0), 0.0);
}

TEST(RangeBearing, WholeTurnsChangeNothing) {
  const RangeBearing<> model{{0.0, 0.0}, 10.0, 0.1};
  const Eigen::Vector2d z(5000.0, 3.1), z_pred(4990.0, -3.1);
  const Eigen::Vector2d residual = model.residual(z, z_pred);
  EXPECT_NEAR(residual(1), 6.2 - 2 * kPi, kAlgebra);
  for (const int turns : {-3, -1, 1, 2}) {
    const Eigen::Vector2d turn(0.0, 2 * kPi * turns);
    EXPECT_TRUE(model.residual(z + turn, z_pred).isApprox(residual, kAlgebra));
    EXPECT_TRUE(model.residual(z, z_pred + turn).isApprox(residual, kAlgebra));
  }
}

TEST(RangeBearing, SeesManyStatesAsItSeesEach) {
  const RangeBearing<> model{{100.0, -200.0}, 10.0, 0.1};
  RandomStream random({23, Role::evaluation, 0}, StreamId::test);
  Eigen::Matrix<double, 4, kMostPoints> X;
  for (int i = 0; i < kMostPoints; ++i)
    X.col(i) << 1e3 * random.normal(), 1e3 * random.normal(), random.normal(), random.normal();
  X.col(3).head<2>() = model.site_m;
  X.col(4).head<2>() = model.site_m + Eigen::Vector2d(1e-3, -5e3);
  X.col(5).head<2>() = model.site_m + Eigen::Vector2d(-1e-3, -5e3);
  for (const int count : {1, 8, 9, kMostPoints})
    for (const double bearing_rad : {-3.14, -1.0, 0.0, 2.0, 3.14}) {
      const Eigen::Vector2d z_0(1500.0, bearing_rad);
      Eigen::Matrix<double, 2, kMostPoints> residuals;
      model.residuals_of(X.data(), 4, count, z_0, residuals.data());
      for (int i = 0; i < count; ++i) {
        const Eigen::Vector2d expected = model.residual(model.h(X.col(i)), z_0);
        EXPECT_EQ(residuals(0, i), expected(0));
        EXPECT_NEAR(residuals(1, i), expected(1), 1e-15) << "point " << i << " from " << bearing_rad;
      }
    }
}

TEST(ConvertRangeBearing, IsTheMatrixOfThePaper) {
  const double range_m = 900.0, bearing_rad = 2.1, sigma_m = 40.0, sigma_rad = 0.2;
  const double s = sigma_rad * sigma_rad, lambda = std::exp(-s / 2), lambda_2 = std::exp(-2 * s);
  const double r2 = range_m * range_m, spread = r2 + sigma_m * sigma_m;
  const double east = std::sin(bearing_rad), north = std::cos(bearing_rad);
  const double loss = 1 / (lambda * lambda) - 2;
  Eigen::Matrix2d R;
  R(0, 0) = loss * r2 * east * east + spread * (1 - lambda_2 * std::cos(2 * bearing_rad)) / 2;
  R(1, 1) = loss * r2 * north * north + spread * (1 + lambda_2 * std::cos(2 * bearing_rad)) / 2;
  R(0, 1) = R(1, 0) = loss * r2 * east * north + spread * lambda_2 * std::sin(2 * bearing_rad) / 2;
  const ConvertedPosition converted = convert_range_bearing({range_m, bearing_rad}, sigma_m, sigma_rad, {7.0, -8.0});
  EXPECT_TRUE(converted.R_m2.isApprox(R, kAlgebra));
  const Eigen::Vector2d position_m = Eigen::Vector2d(7.0, -8.0) + range_m / lambda * Eigen::Vector2d(east, north);
  EXPECT_TRUE(converted.position_m.isApprox(position_m, kAlgebra));
}

struct Errors {
  std::vector<double> along_m, across_m, nees;
};

enum class Conversion { unbiased, plain };

/// Errors of converted positions along and across the true line of sight, and their NEES. The plain conversion is
/// linearised: no factor, sigma_r^2 along and (r sigma_b)^2 across.
Errors converted_errors(Conversion conversion, double range_m, double sigma_deg) {
  constexpr int kDraws = 20000;
  const double bearing_rad = 0.7, sigma_range_m = 50.0, sigma_rad = radians(sigma_deg);
  const Eigen::Vector2d site_m(-300.0, 500.0), u(std::sin(bearing_rad), std::cos(bearing_rad)), v(u.y(), -u.x());
  const Eigen::Vector2d truth_m = site_m + range_m * u;
  RandomStream random({23, Role::evaluation, 0}, StreamId::test);
  Errors errors;
  for (int draw = 0; draw < kDraws; ++draw) {
    const double z_range_m = range_m + sigma_range_m * random.normal();
    const Eigen::Vector2d z(z_range_m, bearing_rad + sigma_rad * random.normal());
    ConvertedPosition converted = convert_range_bearing(z, sigma_range_m, sigma_rad, site_m);
    if (conversion == Conversion::plain) {
      const Eigen::Vector2d along(std::sin(z(1)), std::cos(z(1))), across(along.y(), -along.x());
      converted.position_m = site_m + z(0) * along;
      converted.R_m2 = std::pow(sigma_range_m, 2) * along * along.transpose() +
                       std::pow(z(0) * sigma_rad, 2) * across * across.transpose();
    }
    const Eigen::Vector2d error_m = converted.position_m - truth_m;
    errors.along_m.push_back(error_m.dot(u));
    errors.across_m.push_back(error_m.dot(v));
    errors.nees.push_back(mahalanobis_squared(converted.R_m2, error_m));
  }
  return errors;
}

/// Distance of the mean from where it should be, in margins of its standard error.
double mean_in_margins(const std::vector<double>& values, double expected) {
  const testing::Moments m = testing::moments(values);
  return std::abs(m.mean - expected) / testing::mean_margin(std::sqrt(m.variance), values.size());
}

TEST(ConvertRangeBearing, IsUnbiasedAndHonestAboutItsErrors) {
  for (const auto& [range_m, sigma_deg] : {std::pair(8e3, 0.3), {30e3, 0.3}, {8e3, 3.0}, {30e3, 3.0}}) {
    const Errors errors = converted_errors(Conversion::unbiased, range_m, sigma_deg);
    EXPECT_LT(mean_in_margins(errors.along_m, 0.0), 1.0) << range_m << " m, " << sigma_deg << " deg";
    EXPECT_LT(mean_in_margins(errors.across_m, 0.0), 1.0) << range_m << " m, " << sigma_deg << " deg";
    EXPECT_LT(mean_in_margins(errors.nees, 2.0), 1.0) << range_m << " m, " << sigma_deg << " deg";
  }
}

TEST(ConvertedCovariance, IsTheSpreadAboutTheTruePlace) {
  constexpr int kDraws = 40000;
  const double sigma_m = 50.0, range_m = 20e3;
  const Eigen::Vector2d truth_m = range_m * Eigen::Vector2d(std::sin(2.1), std::cos(2.1));
  for (const double sigma_deg : {0.3, 3.0, 6.0}) {
    RandomStream random({29, Role::evaluation, 0}, StreamId::test);
    Eigen::Matrix2d spread = Eigen::Matrix2d::Zero();
    for (int draw = 0; draw < kDraws; ++draw) {
      const double z_m = range_m + sigma_m * random.normal(), z_rad = 2.1 + radians(sigma_deg) * random.normal();
      const Eigen::Vector2d error_m =
          convert_range_bearing({z_m, z_rad}, sigma_m, radians(sigma_deg), {0.0, 0.0}).position_m - truth_m;
      spread += error_m * error_m.transpose() / kDraws;
    }
    const Eigen::Matrix2d R = converted_covariance(truth_m, sigma_m, radians(sigma_deg));
    const Eigen::Vector2d along = truth_m / range_m, across(along.y(), -along.x());
    EXPECT_NEAR(along.dot(spread * along) / along.dot(R * along), 1.0, 0.05) << sigma_deg << " deg";
    EXPECT_NEAR(across.dot(spread * across) / across.dot(R * across), 1.0, 0.05) << sigma_deg << " deg";
    EXPECT_NEAR(along.dot(R * across), 0.0, 1e-12 * R.trace()) << sigma_deg << " deg";
  }
}

TEST(ConvertRangeBearing, PlainConversionIsCaught) {
  const Errors errors = converted_errors(Conversion::plain, 8e3, 3.0);
  EXPECT_GT(mean_in_margins(errors.along_m, 0.0), 1.0);
  EXPECT_GT(mean_in_margins(errors.nees, 2.0), 1.0);
}

}  // namespace
}  // namespace truebearing::range_bearing_test
