// SPDX-License-Identifier: Apache-2.0
#include "truebearing/array/direction_finding.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>

#include "tests/support/array_scene.hpp"
#include "tests/support/statistics.hpp"
#include "truebearing/array/sample_covariance.hpp"

namespace truebearing::direction_finding_test {
namespace {

using testing::ArrayScene;
using testing::moments;
using testing::scene_of;

Eigen::MatrixXcd exact_subspace(const ArrayScene& scene) {
  return signal_subspace(scene.covariance(), static_cast<int>(scene.angles_rad.size())).basis;
}

Eigen::MatrixXcd drawn_subspace(const ArrayScene& scene, std::uint64_t run) {
  RandomStream random({1, Role::evaluation, run}, StreamId::test);
  Eigen::MatrixXcd R;
  sample_covariance(scene.draw_interval(random), R);
  return signal_subspace(R, static_cast<int>(scene.angles_rad.size())).basis;
}

TEST(DirectionFinding, FindsTheAnglesOfAnExactSubspace) {
  for (const std::vector<double>& angles_deg :
       {std::vector<double>{0.0}, {-50.0, -20.0, 5.0, 20.0, 36.0}, {-75.0, 10.0, 13.0}, {12.345, 61.0}})
    for (const double spacing : {0.5, 0.4}) {
      ArrayScene scene = scene_of(angles_deg);
      scene.spacing_wavelengths = spacing;
      const Eigen::MatrixXcd E = exact_subspace(scene);
      for (const std::vector<double>& found :
           {music_angles(scene.array(), E), esprit_angles(scene.array(), E), signal_angles(scene.array(), E)}) {
        ASSERT_EQ(found.size(), angles_deg.size());
        for (std::size_t n = 0; n < found.size(); ++n) EXPECT_NEAR(found[n], scene.angles_rad[n], 1e-6);
      }
    }
}

TEST(DirectionFinding, OfNoSignalsFindsNone) {
  const Eigen::MatrixXcd E(15, 0);
  EXPECT_TRUE(music_angles({15, 0.5}, E).empty());
  EXPECT_TRUE(esprit_angles({15, 0.5}, E).empty());
  EXPECT_TRUE(signal_angles({15, 0.5}, E).empty());
}

// The Cramer-Rao bound of independent signals (Stoica and Nehorai 1990), which MUSIC's errors reach where the snapshots
// are many, and ESPRIT's do not.
TEST(DirectionFinding, ErrorsAreAsLargeAsTheCramerRaoBoundSays) {
  constexpr std::uint64_t kRuns = 200;
  ArrayScene scene = scene_of({-20.0, 15.0});
  scene.snapshots = 100;
  const Eigen::MatrixXcd R_inverse = scene.covariance().inverse();
  std::vector<double> normalised_music, normalised_esprit;
  std::vector<double> sigma;
  for (std::size_t n = 0; n < 2; ++n) {
    const Eigen::VectorXcd a = testing::steering(scene.array(), scene.angles_rad[n]);
    Eigen::VectorXcd d(15);
    for (int m = 0; m < 15; ++m) d[m] = a[m] * std::complex<double>(0.0, kPi * m * std::cos(scene.angles_rad[n]));
    Eigen::MatrixXcd A(15, 2);
    for (Eigen::Index i = 0; i < 2; ++i)
      A.col(i) = testing::steering(scene.array(), scene.angles_rad[static_cast<std::size_t>(i)]);
    const double outside =
        (d - A * (A.adjoint() * A).partialPivLu().solve(A.adjoint() * d)).squaredNorm();  // d' P_perp d
    const double explained = scene.powers[n] * scene.powers[n] * std::real(a.dot(R_inverse * a));
    sigma.push_back(std::sqrt(scene.noise_power / (2.0 * scene.snapshots * explained * outside)));
  }
  for (std::uint64_t run = 0; run < kRuns; ++run) {
    const Eigen::MatrixXcd E = drawn_subspace(scene, run);
    const std::vector<double> music = music_angles(scene.array(), E), esprit = esprit_angles(scene.array(), E);
    ASSERT_EQ(music.size(), 2u);
    for (std::size_t n = 0; n < 2; ++n) {
      normalised_music.push_back((music[n] - scene.angles_rad[n]) / sigma[n]);
      normalised_esprit.push_back((esprit[n] - scene.angles_rad[n]) / sigma[n]);
    }
  }
  const testing::Moments of_music = moments(normalised_music), of_esprit = moments(normalised_esprit);
  EXPECT_NEAR(of_music.mean, 0.0, testing::mean_margin(1.0, normalised_music.size()));
  EXPECT_TRUE(testing::variance_fits(of_music.variance, 1.0, normalised_music.size())) << of_music.variance;
  EXPECT_NEAR(of_esprit.mean, 0.0, testing::mean_margin(std::sqrt(of_esprit.variance), normalised_esprit.size()));
  EXPECT_GT(of_esprit.variance, of_music.variance);
  EXPECT_LT(of_esprit.variance, 4.0);
  // Half the snapshots are told from all of them.
  EXPECT_FALSE(testing::variance_fits(2.0 * of_music.variance, 1.0, normalised_music.size()));
}

TEST(DirectionFinding, EspritGivesAllAnglesWhereTheSpectrumSeesOnlyOnePeak) {
  ArrayScene scene = scene_of({10.0, 11.0}, 1.0);
  int unresolved = 0;
  for (std::uint64_t run = 0; run < 20; ++run) {
    const Eigen::MatrixXcd E = drawn_subspace(scene, run);
    const std::vector<double> music = music_angles(scene.array(), E), esprit = esprit_angles(scene.array(), E);
    EXPECT_LE(music.size(), 2u);
    EXPECT_EQ(esprit.size(), 2u);
    EXPECT_TRUE(std::is_sorted(esprit.begin(), esprit.end()));
    unresolved += music.size() < 2;
    EXPECT_EQ(signal_angles(scene.array(), E), music.size() == 2 ? music : esprit);
    ASSERT_FALSE(music.empty());
    if (music.size() < 2) {
      EXPECT_NEAR(music[0], radians(10.5), radians(1.0));
    }
  }
  EXPECT_GT(unresolved, 10);
}

// A subspace has local maxima of its spectrum where it has no signal.
TEST(DirectionFinding, SidelobesAreNoPeaks) {
  for (const std::vector<double>& angles_deg : {std::vector<double>{10.0, 10.3}, {-20.0, 10.0, 10.1}}) {
    const ArrayScene scene = scene_of(angles_deg);
    // The same target twice: its steering vector and the derivative of that span the subspace.
    const std::vector<double> found = music_angles(scene.array(), exact_subspace(scene), 181);
    for (const double angle : found) {
      double nearest = 1e9;
      for (const double truth : scene.angles_rad) nearest = std::min(nearest, std::abs(angle - truth));
      EXPECT_LT(nearest, radians(0.5)) << degrees(angle);
    }
  }
}

}  // namespace
}  // namespace truebearing::direction_finding_test
