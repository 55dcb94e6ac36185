// SPDX-License-Identifier: Apache-2.0
#include "truebearing/array/angle_information.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <limits>
#include <vector>

namespace truebearing::angle_information_test {
namespace {

constexpr LineArray kArray{15, 0.5};
constexpr int kSnapshots = 30;

Eigen::VectorXcd steering(const LineArray& array, double angle_rad) {
  Eigen::VectorXcd a(array.sensors);
  for (int m = 0; m < array.sensors; ++m) a[m] = std::polar(1.0, m * array.phase_step(angle_rad));
  return a;
}

Eigen::MatrixXcd covariance(const LineArray& array, const Eigen::VectorXd& angles_rad, const Eigen::VectorXd& snr) {
  Eigen::MatrixXcd R = Eigen::MatrixXcd::Identity(array.sensors, array.sensors);
  for (Eigen::Index n = 0; n < angles_rad.size(); ++n) {
    const Eigen::VectorXcd a = steering(array, angles_rad[n]);
    R += snr[n] * a * a.adjoint();
  }
  return R;
}

// J of [theta, l] (2N x 2N) by its definition, dR by central differences.
Eigen::MatrixXd by_the_trace(const LineArray& array, const Eigen::VectorXd& angles_rad, const Eigen::VectorXd& snr) {
  constexpr double kStep = 1e-5;
  const Eigen::Index N = angles_rad.size();
  const Eigen::MatrixXcd inverse = covariance(array, angles_rad, snr).inverse();
  std::vector<Eigen::MatrixXcd> changes;  // R^-1 dR
  for (Eigen::Index i = 0; i < 2 * N; ++i) {
    Eigen::VectorXd angles[2]{angles_rad, angles_rad}, powers[2]{snr, snr};
    for (int side = 0; side < 2; ++side) {
      const double step = side == 0 ? -kStep : kStep;
      if (i < N)
        angles[side][i] += step;
      else
        powers[side][i - N] *= std::exp(step);
    }
    changes.push_back(inverse * (covariance(array, angles[1], powers[1]) - covariance(array, angles[0], powers[0])) /
                      (2.0 * kStep));
  }
  Eigen::MatrixXd J(2 * N, 2 * N);
  for (Eigen::Index i = 0; i < 2 * N; ++i)
    for (Eigen::Index j = 0; j < 2 * N; ++j)
      J(i, j) =
          kSnapshots * (changes[static_cast<std::size_t>(i)] * changes[static_cast<std::size_t>(j)]).trace().real();
  return J;
}

TEST(AngleInformation, IsTheTraceFormula) {
  const Eigen::Vector3d angles_rad(-0.4, 0.1, 0.17), snr(1.0, 4.0, 0.5);
  const Eigen::MatrixXd wanted = by_the_trace(kArray, angles_rad, snr);
  const AngleInformation J = angle_information(kArray, angles_rad, snr, kSnapshots);
  constexpr double kDifferences = 1e-6;
  const auto expect = [&](const Eigen::MatrixXd& found, const Eigen::MatrixXd& formula) {
    EXPECT_LT((found - formula).norm(), kDifferences * formula.norm()) << found << "\n\n" << formula;
  };
  expect(J.angles, wanted.topLeftCorner(3, 3));
  expect(J.angle_power, wanted.topRightCorner(3, 3));
  expect(J.powers, wanted.bottomRightCorner(3, 3));
  const Eigen::MatrixXd inverse = wanted.inverse();
  expect(J.powers_unknown().inverse(), inverse.topLeftCorner(3, 3));
  expect(J.angle_variances_rad2(), inverse.diagonal().head(3));
  expect(J.powers_known(), wanted.topLeftCorner(3, 3));
  EXPECT_GT((J.powers_unknown() - J.powers_known()).norm(), 1e-3 * J.angles.norm()) << "powers do matter here";
}

// Stoica and Nehorai 1990: of one signal, var = (1 + 1 / (M snr)) / (2 Ns snr |d_perp|^2), d_perp across a, and
// |d_perp|^2 = (2 pi spacing cos theta)^2 M (M^2 - 1) / 12. Its power says nothing of its angle.
TEST(AngleInformation, OfOneSignalIsTheTextbooks) {
  const double angle_rad = 0.3, snr = 2.5, M = kArray.sensors;
  const double turn = 2.0 * kPi * kArray.spacing_wavelengths * std::cos(angle_rad);
  const double across = turn * turn * M * (M * M - 1.0) / 12.0;
  const double wanted = (1.0 + 1.0 / (M * snr)) / (2.0 * kSnapshots * snr * across);
  const AngleInformation J =
      angle_information(kArray, Eigen::VectorXd::Constant(1, angle_rad), Eigen::VectorXd::Constant(1, snr), kSnapshots);
  EXPECT_NEAR(J.angle_variances_rad2()[0], wanted, 1e-12 * wanted);
  EXPECT_NEAR(1.0 / J.powers_known()(0, 0), wanted, 1e-12 * wanted);
}

TEST(AngleInformation, SignalsFarApartDoNotMind) {
  const AngleInformation two =
      angle_information(kArray, Eigen::Vector2d(-0.8, 0.8), Eigen::Vector2d(10.0, 10.0), kSnapshots);
  const AngleInformation one =
      angle_information(kArray, Eigen::VectorXd::Constant(1, 0.8), Eigen::VectorXd::Constant(1, 10.0), kSnapshots);
  EXPECT_NEAR(two.angle_variances_rad2()[1] / one.angle_variances_rad2()[0], 1.0, 0.02);
}

TEST(AngleInformation, TwoFromOneAngleAreNotDeterminedAndTheThirdIs) {
  const AngleInformation J =
      angle_information(kArray, Eigen::Vector3d(0.1, 0.1, -0.6), Eigen::Vector3d(1.0, 2.0, 1.5), kSnapshots);
  const Eigen::VectorXd variances = J.angle_variances_rad2();
  EXPECT_EQ(variances[0], std::numeric_limits<double>::infinity());
  EXPECT_EQ(variances[1], std::numeric_limits<double>::infinity());
  const AngleInformation merged =
      angle_information(kArray, Eigen::Vector2d(0.1, -0.6), Eigen::Vector2d(3.0, 1.5), kSnapshots);
  EXPECT_NEAR(variances[2] / merged.angle_variances_rad2()[1], 1.0, 0.01);
}

TEST(AngleInformation, DeadSensorsAtTheEndsAreAShorterArray) {
  std::vector<double> live(15, 1.0);
  live[0] = live[13] = live[14] = 0.0;
  const Eigen::Vector2d angles_rad(-0.2, 0.3), snr(1.0, 3.0);
  const Eigen::VectorXd found = angle_information(kArray, angles_rad, snr, kSnapshots, live).angle_variances_rad2();
  const Eigen::VectorXd shorter = angle_information({12, 0.5}, angles_rad, snr, kSnapshots).angle_variances_rad2();
  EXPECT_LT((found - shorter).norm(), 1e-10 * shorter.norm());
}

}  // namespace
}  // namespace truebearing::angle_information_test
