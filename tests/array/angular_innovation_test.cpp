// SPDX-License-Identifier: Apache-2.0
#include "truebearing/array/angular_innovation.hpp"

#include <gtest/gtest.h>

#include <Eigen/QR>

#include "tests/support/array_scene.hpp"
#include "truebearing/array/implicit_innovations.hpp"
#include "truebearing/array/projection_approximation.hpp"
#include "truebearing/array/sample_covariance.hpp"
#include "truebearing/simulation/scenario.hpp"

namespace truebearing::angular_innovation_test {
namespace {

using testing::scene_of;

constexpr double kAgreement_rad = radians(1e-9);

struct Innovations {
  AngularInnovation<double> ryu, projection, implicit, together;
};

// Of targets predicted at these angles, each by all three, and together by the last.
std::vector<Innovations> innovations(const LineArray& array, const SplitMatrix<double>& W,
                                     const std::vector<double>& angles_rad) {
  SplitMatrix<double> a, b;
  a.setZero(W.rows(), static_cast<Eigen::Index>(angles_rad.size()));
  b = a;
  RyuInnovation<double> ryu;
  ProjectionInnovation<double> projection;
  ImplicitInnovation<double> implicit;
  ryu.prepare(W);
  projection.prepare(W);
  implicit.prepare(W);
  std::vector<Innovations> all;
  for (Eigen::Index n = 0; n < a.cols(); ++n) array.steer(angles_rad[static_cast<std::size_t>(n)], n, a, b);
  ImplicitInnovations together;
  together.find(array, std::vector<double>(static_cast<std::size_t>(array.sensors), 1.0), angles_rad, W);
  for (Eigen::Index n = 0; n < a.cols(); ++n)
    all.push_back({ryu(a, b, n), projection(a, b, n), implicit(a, b, n), together[static_cast<std::size_t>(n)]});
  return all;
}

void expect_agreement(const Innovations& of, const std::string& where) {
  EXPECT_NEAR(of.projection.angle_rad, of.ryu.angle_rad, kAgreement_rad) << where;
  EXPECT_NEAR(of.implicit.angle_rad, of.ryu.angle_rad, kAgreement_rad) << where;
  EXPECT_NEAR(of.projection.curvature, of.ryu.curvature, 1e-9 * of.ryu.curvature) << where;
  EXPECT_NEAR(of.implicit.curvature, of.ryu.curvature, 1e-9 * of.ryu.curvature) << where;
  EXPECT_NEAR(of.together.angle_rad, of.ryu.angle_rad, kAgreement_rad) << where;
  EXPECT_NEAR(of.together.curvature, of.ryu.curvature, 1e-9 * of.ryu.curvature) << where;
}

Eigen::MatrixXcd random_matrix(RandomStream& random, Eigen::Index rows, Eigen::Index columns) {
  Eigen::MatrixXcd matrix(rows, columns);
  for (std::complex<double>& value : matrix.reshaped()) value = testing::complex_normal(random);
  return matrix;
}

// The columns of A in other coordinates, which span the same.
SplitMatrix<double> same_span(RandomStream& random, const testing::ArrayScene& scene) {
  const Eigen::Index N = static_cast<Eigen::Index>(scene.angles_rad.size());
  Eigen::MatrixXcd A(scene.sensors, N);
  for (Eigen::Index n = 0; n < N; ++n)
    A.col(n) = testing::steering(scene.array(), scene.angles_rad[static_cast<std::size_t>(n)]);
  return testing::split(A * (Eigen::MatrixXcd::Identity(N, N) + 0.2 * random_matrix(random, N, N)));
}

TEST(AngularInnovation, ThreeWaysAgreeOnRandomSubspaces) {
  RandomStream random({1, Role::evaluation, 0}, StreamId::test);
  for (int trial = 0; trial < 100; ++trial) {
    const int M = 4 + static_cast<int>(random.index(20)), N = 1 + static_cast<int>(random.index(3));
    const SplitMatrix<double> W = testing::split(random_matrix(random, M, N));
    std::vector<double> angles;
    for (int n = 0; n < N; ++n) angles.push_back(random.uniform(-1.2, 1.2));
    for (const Innovations& of : innovations({M, 0.5}, W, angles))
      expect_agreement(of, std::to_string(M) + " sensors, " + std::to_string(N) + " targets");
  }
}

// In registers of every filling, of sensors that are alive or not, whatever was found before.
TEST(AngularInnovation, OfAllTargetsAtOnceIsThatOfEach) {
  RandomStream random({4, Role::evaluation, 0}, StreamId::test);
  ImplicitInnovations together;
  ImplicitInnovation<double> alone;
  for (const int N : {12, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11}) {
    const int M = 2 * N + 3 + static_cast<int>(random.index(20));
    const LineArray array{M, random.uniform(0.2, 1.5)};
    std::vector<double> live(static_cast<std::size_t>(M), 1.0), angles;
    live[random.index(static_cast<std::size_t>(M))] = 0.0;
    for (int n = 0; n < N; ++n) angles.push_back(random.uniform(-1.2, 1.2));
    const SplitMatrix<double> W = testing::split(random_matrix(random, M, N));
    SplitMatrix<double> a, b;
    a.setZero(M, N);
    b = a;
    for (int n = 0; n < N; ++n) array.steer(angles[static_cast<std::size_t>(n)], n, a, b);
    const Eigen::Map<const Eigen::VectorXd> alive(live.data(), M);
    for (Eigen::MatrixXd* part : {&a.re, &a.im, &b.re, &b.im}) *part = (alive.asDiagonal() * *part).eval();
    together.find(array, live, angles, W);
    alone.prepare(W);
    for (std::size_t n = 0; n < angles.size(); ++n) {
      const AngularInnovation<double> expected = alone(a, b, static_cast<Eigen::Index>(n));
      const double b2 = detail::real_product(b, static_cast<Eigen::Index>(n), b, static_cast<Eigen::Index>(n));
      EXPECT_NEAR(together[n].angle_rad, expected.angle_rad, 1e-11 * std::abs(expected.angle_rad) + 1e-14) << N;
      EXPECT_NEAR(together[n].curvature, expected.curvature, 1e-12 * b2) << N;
      EXPECT_NEAR(together.derivative_norm2(n), b2, 1e-12 * b2) << N;
    }
  }
}

TEST(AngularInnovation, IsTheLeastSquaresSolution) {
  RandomStream random({2, Role::evaluation, 0}, StreamId::test);
  const Eigen::MatrixXcd W = random_matrix(random, 15, 4);
  SplitMatrix<double> a, b;
  a.setZero(15, 1);
  b = a;
  const LineArray array{15, 0.5};
  array.steer(0.3, 0, a, b);
  // a + b d_theta = W c with d_theta real and c complex, in real numbers.
  Eigen::MatrixXd A(30, 9);
  A << W.real(), -W.imag(), -b.re, W.imag(), W.real(), -b.im;
  Eigen::VectorXd right(30);
  right << a.re, a.im;
  const Eigen::VectorXd solution = A.colPivHouseholderQr().solve(right);
  EXPECT_NEAR(innovations(array, testing::split(W), {0.3})[0].implicit.angle_rad, solution[8], kAgreement_rad);
}

TEST(AngularInnovation, ThreeWaysAgreeOnARun) {
  const Recording recording =
      load_scenario(TRUEBEARING_SOURCE_DIR "/data/scenarios/array_a_10db.toml")->simulate({1, Role::evaluation, 0});
  ProjectionApproximation past(0.95);
  Interval interval;
  for (std::size_t k = 0; k < recording.measurements.size(); ++k) {
    interval.take(*recording.measurements[k].snapshots);
    if (k == 0) {
      Eigen::MatrixXcd R;
      sample_covariance(interval, R);
      past.begin(signal_subspace(R, 5).basis);
    }
    past.update(interval);
    std::vector<double> angles;  // a little off, so that there is something to find
    for (const Truth& truth : recording.truth) angles.push_back(truth.x[k][0] + radians(0.5));
    for (const Innovations& of : innovations({15, 0.5}, past.basis(), angles))
      expect_agreement(of, "interval " + std::to_string(k));
  }
}

TEST(AngularInnovation, PaddingWithZerosChangesNothing) {
  RandomStream random({3, Role::evaluation, 0}, StreamId::test);
  const SplitMatrix<double> W = testing::split(random_matrix(random, 15, 3));
  SplitMatrix<double> padded;
  padded.setZero(16, 3);
  padded.re.topRows(15) = W.re;
  padded.im.topRows(15) = W.im;
  EXPECT_NEAR(innovations({15, 0.5}, padded, {0.3})[0].implicit.angle_rad,
              innovations({15, 0.5}, W, {0.3})[0].implicit.angle_rad, kAgreement_rad);
}

// With P_perp a(theta_0) = 0, and b' = db / d theta: error = k delta^2 + O(delta^3), k = Re(b^H P_perp b') / (2 b^H
// P_perp b), a delta too far.
TEST(AngularInnovation, ErrorOfOneStepIsOfSecondOrder) {
  constexpr double kStep_rad = 1e-5;
  RandomStream random({4, Role::evaluation, 0}, StreamId::test);
  const testing::ArrayScene scene = scene_of({-30.0, 2.0, 17.0, 40.0});
  const SplitMatrix<double> W = same_span(random, scene);
  const Eigen::MatrixXcd columns = testing::joined(W, 15);
  const Eigen::MatrixXcd P_perp =
      Eigen::MatrixXcd::Identity(15, 15) -
      columns * (columns.adjoint() * columns).ldlt().solve(Eigen::MatrixXcd(columns.adjoint()));
  const auto derivative = [&](double angle_rad) {
    SplitMatrix<double> a, b;
    a.setZero(15, 1);
    b = a;
    scene.array().steer(angle_rad, 0, a, b);
    return Eigen::VectorXcd(testing::joined(b, 15).col(0));
  };
  for (std::size_t n = 0; n < 4; ++n) {
    const auto beyond_second_order = [&](double off_rad) {
      std::vector<double> predicted = scene.angles_rad;
      predicted[n] += off_rad;
      const Eigen::VectorXcd b = derivative(predicted[n]);
      const Eigen::VectorXcd turning =
          (derivative(predicted[n] + kStep_rad) - derivative(predicted[n] - kStep_rad)) / (2.0 * kStep_rad);
      const double k = 0.5 * std::real(b.dot(P_perp * turning)) / std::real(b.dot(P_perp * b));
      const double error_rad = off_rad + innovations(scene.array(), W, predicted)[n].implicit.angle_rad;
      EXPECT_LT(std::abs(error_rad), 0.1 * off_rad) << n;
      return error_rad - k * off_rad * off_rad;
    };
    EXPECT_NEAR(innovations(scene.array(), W, scene.angles_rad)[n].implicit.angle_rad, 0.0, 1e-12);
    EXPECT_NEAR(beyond_second_order(radians(0.2)) / beyond_second_order(radians(0.1)), 8.0, 0.8) << n;
  }
}

TEST(AngularInnovation, CoincidentPairGivesFiniteValues) {
  RandomStream random({5, Role::evaluation, 0}, StreamId::test);
  const testing::ArrayScene scene = scene_of({10.0, 10.02, 40.0});
  const std::vector<Innovations> all =
      innovations(scene.array(), same_span(random, scene), {radians(10.01), radians(10.01), radians(39.0)});
  for (const Innovations& of : all)
    for (const AngularInnovation<double>& way : {of.ryu, of.projection, of.implicit}) {
      EXPECT_TRUE(std::isfinite(way.angle_rad));
      EXPECT_TRUE(std::isfinite(way.curvature));
    }
  // The pair's subspace holds the derivative at its middle as well: the curvature says that there is nothing to go by.
  EXPECT_LT(std::abs(all[0].implicit.curvature), 1e-9 * all[2].implicit.curvature);
  EXPECT_EQ(all[0].implicit.angle_rad, all[1].implicit.angle_rad);
  EXPECT_NEAR(all[2].implicit.angle_rad, radians(1.0), radians(0.1));
}

}  // namespace
}  // namespace truebearing::angular_innovation_test
