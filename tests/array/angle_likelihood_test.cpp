// SPDX-License-Identifier: Apache-2.0
#include "truebearing/array/angle_likelihood.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>

#include "tests/support/array_scene.hpp"
#include "truebearing/array/sample_covariance.hpp"
#include "truebearing/core/chi_square.hpp"
#include "truebearing/core/covariance.hpp"

namespace truebearing::angle_likelihood_test {
namespace {

using testing::ArrayScene;
using testing::scene_of;
using testing::Snapshots;

constexpr double kNoise = 1.7;

ArrayScene scene(int sensors = 15) {
  ArrayScene scene = scene_of({-35.0, 4.0, 12.0});
  scene.powers = {12.0, 5.0, 30.0};
  scene.noise_power = kNoise;
  scene.sensors = sensors;
  return scene;
}

RealInterval real(const ArrayScene& of, const Snapshots& values, int blocks = 1) {
  RealInterval taken;
  taken.take(of.interval(values), blocks);
  return taken;
}

Snapshots draw(const ArrayScene& of, std::uint64_t run = 0) {
  RandomStream random({1, Role::evaluation, run}, StreamId::test);
  return of.draw(random);
}

// [theta, l] of a scene.
SignalVector parameters(const ArrayScene& of) {
  const Eigen::Index N = static_cast<Eigen::Index>(of.angles_rad.size());
  SignalVector m(2 * N);
  for (Eigen::Index n = 0; n < N; ++n) {
    m[n] = of.angles_rad[static_cast<std::size_t>(n)];
    m[N + n] = std::log(of.powers[static_cast<std::size_t>(n)]);
  }
  return m;
}

ArrayScene with(const ArrayScene& of, const SignalVector& m) {
  ArrayScene other = of;
  const Eigen::Index N = m.size() / 2;
  other.angles_rad.assign(m.begin(), m.begin() + N);
  other.powers.clear();
  for (Eigen::Index n = 0; n < N; ++n) other.powers.push_back(std::exp(m[N + n]));
  return other;
}

// A little off the truth, so that gradients are not small.
SignalVector somewhere() {
  SignalVector m = parameters(scene());
  m += (SignalVector(6) << 0.01, -0.02, 0.004, 0.3, -0.2, 0.1).finished();
  return m;
}

// -Ns [log det R + tr(R^-1 R_hat)] in complex numbers.
double direct_log_likelihood(const ArrayScene& of, const Snapshots& values, const SignalVector& m) {
  Eigen::MatrixXcd R_hat;
  sample_covariance(of.interval(values), R_hat);
  const Eigen::MatrixXcd R = with(of, m).covariance();
  const Eigen::PartialPivLU<Eigen::MatrixXcd> solver(R);
  return -of.snapshots * (std::log(std::abs(solver.determinant())) + solver.solve(R_hat).trace().real());
}

TEST(AngleLikelihood, EqualsTheFormulaInComplexNumbers) {
  for (const int sensors : {8, 15, 16, 30}) {
    const ArrayScene of = scene(sensors);
    const Snapshots values = draw(of);
    AngleLikelihood likelihood;
    for (const SignalVector& m : {parameters(of), somewhere()}) {
      ASSERT_TRUE(likelihood.evaluate(real(of, values), m, nullptr, 0.0, kNoise));
      const double direct = direct_log_likelihood(of, values, m);
      EXPECT_NEAR(likelihood.log_likelihood(), direct, 1e-10 * std::abs(direct)) << sensors;
    }
  }
}

TEST(AngleLikelihood, OfNoSignalsIsThatOfNoise) {
  const ArrayScene of = scene();
  const Snapshots values = draw(of);
  AngleLikelihood likelihood;
  ASSERT_TRUE(likelihood.evaluate(real(of, values), SignalVector(0), nullptr, 0.0, kNoise));
  const double direct = direct_log_likelihood(of, values, SignalVector(0));
  EXPECT_NEAR(likelihood.log_likelihood(), direct, 1e-10 * std::abs(direct));
  EXPECT_EQ(likelihood.gradient().size(), 0);
}

// With two dead sensors, one pair and the middle: the complex formula of what is left.
TEST(AngleLikelihood, LeavesDeadSensorsOut) {
  const ArrayScene of = scene();
  Snapshots values = draw(of);
  std::vector<int> left;
  for (int m = 0; m < 15; ++m)
    if (m != 2 && m != 12 && m != 7) left.push_back(m);
  for (int t = 0; t < 30; ++t)
    for (const int m : {2, 12, 7}) values[static_cast<std::size_t>(t * 15 + m)] = 0.0;
  Eigen::MatrixXcd R_hat;
  sample_covariance(of.interval(values), R_hat);
  const Eigen::MatrixXcd R = with(of, somewhere()).covariance()(left, left);
  const double direct = -30.0 * (std::log(std::abs(R.determinant())) +
                                 (R.inverse() * Eigen::MatrixXcd(R_hat(left, left))).trace().real());
  AngleLikelihood likelihood;
  ASSERT_TRUE(likelihood.evaluate(real(of, values), somewhere(), nullptr, 0.0, kNoise));
  EXPECT_NEAR(likelihood.log_likelihood(), direct, 1e-10 * std::abs(direct));
}

TEST(AngleLikelihood, GradientIsThatOfFiniteDifferences) {
  const ArrayScene of = scene();
  const SignalVector rate = (SignalVector(3) << 0.03, -0.02, 0.01).finished();
  AngleLikelihood likelihood;
  for (const int blocks : {1, 3}) {
    const RealInterval interval = real(of, draw(of), blocks);
    const SignalVector* moving = blocks > 1 ? &rate : nullptr;
    ASSERT_TRUE(likelihood.evaluate(interval, somewhere(), moving, -0.4, kNoise));
    const SignalVector gradient = likelihood.gradient();
    for (Eigen::Index i = 0; i < 6; ++i) {
      constexpr double kStep = 1e-5;
      SignalVector above = somewhere(), below = somewhere();
      above[i] += kStep;
      below[i] -= kStep;
      ASSERT_TRUE(likelihood.evaluate(interval, above, moving, -0.4, kNoise));
      const double high = likelihood.log_likelihood();
      ASSERT_TRUE(likelihood.evaluate(interval, below, moving, -0.4, kNoise));
      const double difference = (high - likelihood.log_likelihood()) / (2.0 * kStep);
      EXPECT_NEAR(gradient[i], difference, 1e-6 * gradient.norm()) << i;
    }
  }
}

TEST(AngleLikelihood, InformationIsTheTraceFormula) {
  const ArrayScene of = scene();
  const SignalVector m = somewhere();
  std::vector<Eigen::MatrixXcd> dR;
  for (Eigen::Index i = 0; i < 6; ++i) {
    constexpr double kStep = 1e-6;
    SignalVector above = m, below = m;
    above[i] += kStep;
    below[i] -= kStep;
    dR.emplace_back((with(of, above).covariance() - with(of, below).covariance()) / (2.0 * kStep));
  }
  const Eigen::MatrixXcd inverse = with(of, m).covariance().inverse();
  AngleLikelihood likelihood;
  ASSERT_TRUE(likelihood.evaluate(real(of, draw(of)), m, nullptr, 0.0, kNoise));
  for (std::size_t i = 0; i < 6; ++i)
    for (std::size_t j = 0; j < 6; ++j) {
      const Eigen::Index row = static_cast<Eigen::Index>(i), column = static_cast<Eigen::Index>(j);
      const double direct = 30.0 * (inverse * dR[i] * inverse * dR[j]).trace().real();
      const SignalMatrix& J = likelihood.information();
      EXPECT_NEAR(J(row, column), direct, 1e-6 * std::sqrt(J(row, row) * J(column, column))) << i << ", " << j;
    }
  EXPECT_TRUE(is_covariance(likelihood.information()));
}

// At the truth g ~ (0, J): the sum of g' J^-1 g over runs is chi-square with 6 of each, nearly, g being a sum over 30
// snapshots; J of half the noise power is caught.
TEST(AngleLikelihood, InformationIsTheCovarianceOfTheGradient) {
  constexpr int kRuns = 500;
  const ArrayScene of = scene();
  const auto statistic = [&](double noise_power) {
    double sum = 0.0;
    AngleLikelihood likelihood;
    for (std::uint64_t run = 0; run < kRuns; ++run) {
      EXPECT_TRUE(likelihood.evaluate(real(of, draw(of, run)), parameters(of), nullptr, 0.0, noise_power));
      sum += mahalanobis_squared(likelihood.information(), likelihood.gradient());
    }
    return sum;
  };
  const double low = chi_square_quantile(1e-4, 6.0 * kRuns), high = chi_square_quantile(1.0 - 1e-4, 6.0 * kRuns);
  const double sum = statistic(kNoise);
  EXPECT_GT(sum, low);
  EXPECT_LT(sum, high);
  EXPECT_GT(statistic(0.5 * kNoise), high);
}

TEST(AngleLikelihood, MovingBlocksAddUpEachWithItsTargetsWhereTheyAreThen) {
  const ArrayScene of = scene();
  const Snapshots values = draw(of);
  const RealInterval three = real(of, values, 3);
  const SignalVector rate = (SignalVector(3) << 0.03, -0.02, 0.01).finished();
  constexpr double kMiddle_s = -0.4833;
  AngleLikelihood likelihood;
  ASSERT_TRUE(likelihood.evaluate(three, somewhere(), &rate, kMiddle_s, kNoise));
  double log_likelihood = 0.0;
  SignalVector gradient = SignalVector::Zero(6);
  SignalMatrix J = SignalMatrix::Zero(6, 6);
  ArrayScene part = of;
  part.snapshots = 10;
  AngleLikelihood alone;
  for (int b = 0; b < 3; ++b) {
    SignalVector m = somewhere();
    m.head(3) += (three.block(b).time_s - kMiddle_s) * rate;
    const Snapshots of_block(values.begin() + b * 150, values.begin() + (b + 1) * 150);
    ASSERT_TRUE(alone.evaluate(real(part, of_block), m, nullptr, 0.0, kNoise));
    log_likelihood += alone.log_likelihood();
    gradient += alone.gradient();
    J += alone.information();
  }
  EXPECT_NEAR(likelihood.log_likelihood(), log_likelihood, 1e-12 * std::abs(log_likelihood));
  EXPECT_LT((likelihood.gradient() - gradient).norm(), 1e-10 * gradient.norm());
  EXPECT_LT((likelihood.information() - J).norm(), 1e-12 * J.norm());
}

TEST(AngleLikelihood, BlocksOfTargetsThatStandStillAreOneInterval) {
  const ArrayScene of = scene();
  const Snapshots values = draw(of);
  AngleLikelihood whole, blocks;
  ASSERT_TRUE(whole.evaluate(real(of, values), somewhere(), nullptr, 0.0, kNoise));
  ASSERT_TRUE(blocks.evaluate(real(of, values, 3), somewhere(), nullptr, 0.0, kNoise));
  EXPECT_NEAR(whole.log_likelihood(), blocks.log_likelihood(), 1e-12 * std::abs(whole.log_likelihood()));
  EXPECT_LT((whole.gradient() - blocks.gradient()).norm(), 1e-9 * whole.gradient().norm());
  for (int n = 0; n < 3; ++n) EXPECT_NEAR(whole.presence(n), blocks.presence(n), 1e-9 * whole.presence(n));
  EXPECT_NEAR(whole.residual_power(), blocks.residual_power(), 1e-9);
}

// Presence is twice what the log likelihood gains by a signal whose power is the best one.
TEST(AngleLikelihood, PresenceIsTwiceTheGainOfTheLogLikelihood) {
  const ArrayScene of = scene();
  const RealInterval interval = real(of, draw(of));
  AngleLikelihood likelihood;
  const SignalVector others = (SignalVector(4) << parameters(of).head(2), parameters(of).segment(3, 2)).finished();
  ASSERT_TRUE(likelihood.evaluate(interval, others, nullptr, 0.0, kNoise));
  const double without = likelihood.log_likelihood();
  double best = without;
  for (double log_power = 0.0; log_power < 6.0; log_power += 0.001) {
    SignalVector m = parameters(of);
    m[5] = log_power;
    ASSERT_TRUE(likelihood.evaluate(interval, m, nullptr, 0.0, kNoise));
    best = std::max(best, likelihood.log_likelihood());
  }
  ASSERT_TRUE(likelihood.evaluate(interval, parameters(of), nullptr, 0.0, kNoise));
  EXPECT_NEAR(likelihood.presence(2), 2.0 * (best - without), 1e-3 * likelihood.presence(2));
}

// Of a signal that is not there it is that of one parameter which only noise moves, and upwards only: chi-square with
// one degree of freedom in half of all intervals, zero in the others.
TEST(AngleLikelihood, PresenceTellsWhoIsThere) {
  constexpr std::uint64_t kRuns = 100;
  const ArrayScene of = scene();
  SignalVector m(8);
  m << parameters(of).head(3), radians(-60.0), parameters(of).tail(3), std::log(2.0);
  AngleLikelihood likelihood;
  int zeros = 0;
  for (std::uint64_t run = 0; run < kRuns; ++run) {
    ASSERT_TRUE(likelihood.evaluate(real(of, draw(of, run)), m, nullptr, 0.0, kNoise));
    for (int n = 0; n < 3; ++n) EXPECT_GT(likelihood.presence(n), 50.0);
    EXPECT_LT(likelihood.presence(3), chi_square_quantile(1.0 - 1e-5 / kRuns, 1.0));
    zeros += likelihood.presence(3) == 0.0;
  }
  EXPECT_GT(zeros, 30);
  EXPECT_LT(zeros, 80);
}

TEST(AngleLikelihood, ResidualPowerIsThatOfTheNoise) {
  constexpr std::uint64_t kRuns = 200;
  const ArrayScene of = scene();
  AngleLikelihood likelihood;
  for (const double believed : {kNoise, 0.5 * kNoise}) {
    double mean = 0.0;
    for (std::uint64_t run = 0; run < kRuns; ++run) {
      ASSERT_TRUE(likelihood.evaluate(real(of, draw(of, run)), parameters(of), nullptr, 0.0, believed));
      mean += likelihood.residual_power() / kRuns;
    }
    // Of 12 * 30 * 200 complex values, 4.5 sigma.
    EXPECT_NEAR(mean, kNoise, 4.5 * kNoise / std::sqrt(12.0 * 30.0 * kRuns) + 0.02 * std::abs(kNoise - believed));
  }
}

TEST(AngleLikelihood, SearchFindsTheTargetThatIsNotModelled) {
  const ArrayScene of = scene();
  std::vector<double> grid;
  for (int g = 0; g < 128; ++g) grid.push_back(std::asin(0.99 * (2.0 * g / 127.0 - 1.0)));
  AngleLikelihood likelihood;
  for (int left_out = 0; left_out < 3; ++left_out) {
    SignalVector m(4);
    for (int n = 0, i = 0; n < 3; ++n)
      if (n != left_out) {
        m[i] = parameters(of)[n];
        m[2 + i++] = parameters(of)[3 + n];
      }
    const RealInterval interval = real(of, draw(of));
    const AngleLikelihood::Newcomer found = likelihood.search(interval, m, nullptr, 0.0, kNoise, grid);
    EXPECT_NEAR(std::sin(found.angle_rad), std::sin(parameters(of)[left_out]), 0.99 / 127.0 + 0.01) << left_out;
    EXPECT_NEAR(found.log_power, parameters(of)[3 + left_out], 1.0);
    EXPECT_GT(found.presence, 50.0);
    // It is the presence that the target then has.
    SignalVector more(6);
    more << m.head(2), found.angle_rad, m.tail(2), found.log_power;
    ASSERT_TRUE(likelihood.evaluate(interval, more, nullptr, 0.0, kNoise));
    EXPECT_NEAR(likelihood.presence(2), found.presence, 1e-9 * found.presence);
    EXPECT_NEAR(likelihood.gradient()[5], 0.0, 1e-9 * found.presence);  // its power is the best one
  }
  const AngleLikelihood::Newcomer nobody =
      likelihood.search(real(of, draw(of)), parameters(of), nullptr, 0.0, kNoise, grid);
  EXPECT_LT(nobody.presence, 30.0);
}

TEST(AngleLikelihood, SaysWhereTheArithmeticFails) {
  const ArrayScene of = scene();
  SignalVector m = parameters(of);
  AngleLikelihood likelihood;
  m[1] = std::nan("");
  EXPECT_FALSE(likelihood.evaluate(real(of, draw(of)), m, nullptr, 0.0, kNoise));
  m = parameters(of);
  EXPECT_FALSE(likelihood.evaluate(real(of, draw(of)), m, nullptr, 0.0, std::nan("")));
  EXPECT_TRUE(likelihood.evaluate(real(of, draw(of)), m, nullptr, 0.0, kNoise));
}

}  // namespace
}  // namespace truebearing::angle_likelihood_test
