// SPDX-License-Identifier: Apache-2.0
#include "truebearing/array/projection_approximation.hpp"

#include <gtest/gtest.h>

#include <Eigen/QR>
#include <Eigen/SVD>

#include "tests/support/array_scene.hpp"
#include "truebearing/array/sample_covariance.hpp"

namespace truebearing::projection_approximation_test {
namespace {

using testing::ArrayScene;
using testing::scene_of;

constexpr double kBeta = 0.95;

// Yang 1995, table I, as it is written; without the mirrored triangle where `is_mirrored` is false.
struct PlainPast {
  Eigen::MatrixXcd W, P;
  bool is_mirrored = true;

  explicit PlainPast(const Eigen::MatrixXcd& basis) : W(basis), P(Eigen::MatrixXcd::Identity(W.cols(), W.cols())) {}

  void take(const Eigen::VectorXcd& x) {
    const Eigen::VectorXcd y = W.adjoint() * x, h = P * y;
    const Eigen::VectorXcd g = h / (kBeta + y.dot(h));
    P = ((P - g * h.adjoint()) / kBeta).eval();
    if (is_mirrored) P = P.selfadjointView<Eigen::Lower>();
    W += (x - W * y) * g.adjoint();
  }
  void take(const Interval& interval) {
    for (int t = 0; t < interval.snapshots(); ++t) {
      Eigen::VectorXcd x(interval.sensors());
      for (int m = 0; m < interval.sensors(); ++m) x[m] = interval.value(t, m);
      take(x);
    }
  }
};

Eigen::MatrixXcd first_basis(const Interval& interval, int targets) {
  Eigen::MatrixXcd R;
  sample_covariance(interval, R);
  return signal_subspace(R, targets).basis;
}

// Sine of the largest angle between the spans of W and of the scene's steering vectors.
double largest_sine(const Eigen::MatrixXcd& W, const ArrayScene& scene) {
  Eigen::MatrixXcd A(scene.sensors, static_cast<Eigen::Index>(scene.angles_rad.size()));
  for (Eigen::Index n = 0; n < A.cols(); ++n)
    A.col(n) = testing::steering(scene.array(), scene.angles_rad[static_cast<std::size_t>(n)]);
  const auto span = [](const Eigen::MatrixXcd& columns) {
    return Eigen::MatrixXcd(Eigen::HouseholderQR<Eigen::MatrixXcd>(columns).householderQ() *
                            Eigen::MatrixXcd::Identity(columns.rows(), columns.cols()));
  };
  const Eigen::MatrixXcd Q = span(W), outside = span(A) - Q * (Q.adjoint() * span(A));
  return Eigen::JacobiSVD<Eigen::MatrixXcd>(outside).singularValues()[0];
}

TEST(ProjectionApproximation, EqualsPastInPlainComplexNumbers) {
  for (const int sensors : {15, 16, 17}) {
    ArrayScene scene = scene_of({-50.0, -20.0, 5.0, 20.0, 36.0});
    scene.sensors = sensors;
    RandomStream random({1, Role::evaluation, 0}, StreamId::test);
    const Eigen::MatrixXcd basis = first_basis(scene.draw_interval(random), 5);
    ProjectionApproximation past(kBeta);
    past.begin(basis);
    EXPECT_EQ(testing::joined(past.basis(), sensors), basis);
    PlainPast plain(basis);
    for (int k = 0; k < 3; ++k) {
      const Interval interval = scene.draw_interval(random);
      past.update(interval);
      plain.take(interval);
      EXPECT_LT((testing::joined(past.basis(), sensors) - plain.W).cwiseAbs().maxCoeff(), 1e-10) << k;
    }
    const Eigen::Index padding = past.basis().rows() - sensors;
    EXPECT_EQ(past.basis().rows() % 8, 0);
    EXPECT_TRUE(past.basis().re.bottomRows(padding).isZero(0.0) && past.basis().im.bottomRows(padding).isZero(0.0));
  }
}

TEST(ProjectionApproximation, LeavesOutWhatIsMissing) {
  const ArrayScene scene = scene_of({-20.0, 20.0});
  RandomStream random({2, Role::evaluation, 0}, StreamId::test);
  const Eigen::MatrixXcd basis = first_basis(scene.draw_interval(random), 2);
  testing::Snapshots values = scene.draw(random);
  values[7 * 15 + 3] = {std::nan(""), 0.0};
  ProjectionApproximation past(kBeta);
  past.begin(basis);
  past.update(scene.interval(values));
  values.erase(values.begin() + 7 * 15, values.begin() + 8 * 15);
  PlainPast plain(basis);
  plain.take(scene.interval(values));
  EXPECT_LT((testing::joined(past.basis(), 15) - plain.W).cwiseAbs().maxCoeff(), 1e-10);
}

// 15,000 snapshots: rounding that grew as beta^-t would be out of all range long before. The subspace that it ends with
// is as good as one that began a moment ago, and both are not much worse than beta's window of 20 snapshots allows:
// each of the M - N directions outside is in error by 1 / (20 M snr), about.
TEST(ProjectionApproximation, StaysGoodOverFiveHundredIntervals) {
  const ArrayScene scene = scene_of({-50.0, -20.0, 5.0, 20.0, 36.0});
  RandomStream random({3, Role::evaluation, 0}, StreamId::test);
  const Eigen::MatrixXcd basis = first_basis(scene.draw_interval(random), 5);
  ProjectionApproximation past(kBeta), young(kBeta);
  past.begin(basis);
  PlainPast unmirrored(basis);
  unmirrored.is_mirrored = false;
  double sum_of_squares = 0.0;
  for (int k = 0; k < 500; ++k) {
    const Interval interval = scene.draw_interval(random);
    past.update(interval);
    if (k < 100) unmirrored.take(interval);
    const double sine = largest_sine(testing::joined(past.basis(), 15), scene);
    ASSERT_LT(sine, 0.8) << k;
    sum_of_squares += sine * sine / 500.0;
    if (k == 480) young.begin(first_basis(interval, 5));
    if (k > 480) young.update(interval);
  }
  const double window_error = std::sqrt(10.0 / (20.0 * 15.0 * 10.0) * 5.0);
  EXPECT_LT(std::sqrt(sum_of_squares), 2.0 * window_error);
  EXPECT_NEAR(largest_sine(testing::joined(past.basis(), 15), scene),
              largest_sine(testing::joined(young.basis(), 15), scene), 1e-6);
  EXPECT_FALSE(unmirrored.P.allFinite());  // what the mirror is for
}

}  // namespace
}  // namespace truebearing::projection_approximation_test
