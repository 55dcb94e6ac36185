// SPDX-License-Identifier: Apache-2.0
#include "truebearing/tma/doppler_term.hpp"

#include <gtest/gtest.h>

#include "tests/support/bearing_frequency_runs.hpp"
#include "tests/support/jacobian.hpp"
#include "truebearing/tma/levenberg_marquardt.hpp"

namespace truebearing::doppler_term_test {
namespace {

using testing::jump;
using testing::KimSong;

constexpr double kJacobian = 1e-6;
const Eigen::Vector4d kSteps(1e-5, 1e-8, 1e-8, 1e-9);

// Kim and Song's scenario with noise, the source at 130 Hz from 600 to 800 s and known to be.
class DopplerTermTest : public ::testing::Test {
 protected:
  DopplerTermTest() : windows_(KimSong::windows(3, jump(30.0, 600.0, 800.0))) {
    std::vector<int> level;
    for (std::size_t i = 0; i < window().size(); ++i)
      level.push_back(window().time_s(i) >= 600.0 && window().time_s(i) < 800.0);
    window().set_levels(level);
    polar_.look_at(windows_.bearings);
    term_.look_at(polar_, &window());
    y_ = polar_.from_cartesian(KimSong::target(polar_.origin_s())) + Eigen::Vector4d(0.02, 3e-5, -2e-5, 1e-5);
  }
  DopplerWindow& window() { return windows_.frequencies; }
  NormalEquations<4> share(const Eigen::Vector4d& y) const {
    NormalEquations<4> equations;
    term_.add(y, equations);
    return equations;
  }

  /// Bearings and frequencies, the two f0s as parameters, by way of the Cartesian state.
  NormalEquations<6> whole(const Eigen::Matrix<double, 6, 1>& p, bool with_bearings) {
    const Eigen::Vector4d y = p.head<4>();
    const Eigen::Vector4d x = polar_.to_cartesian(y);
    const Eigen::Matrix4d T = polar_.jacobian(y);
    NormalEquations<6> equations;
    if (with_bearings) {
      const NormalEquations<4> of_bearings = polar_(y);
      equations.cost = of_bearings.cost;
      equations.gradient.head<4>() = of_bearings.gradient;
      equations.A.topLeftCorner<4, 4>() = of_bearings.A;
    }
    for (std::size_t i = 0; i < window().size(); ++i) {
      const DopplerWindow::Shift shift = window().shift(i, x, polar_.origin_s());
      const double f0 = p[4 + window().level(i)], r = window().frequency_hz(i) - f0 * shift.value;
      Eigen::Matrix<double, 1, 6> J = Eigen::Matrix<double, 1, 6>::Zero();
      J.head<4>() = f0 * shift.per_state * T;
      J[4 + window().level(i)] = shift.value;
      equations.cost += 0.5 * window().weight(i) * r * r;
      equations.gradient += window().weight(i) * r * J.transpose();
      equations.A += window().weight(i) * J.transpose() * J;
    }
    return equations;
  }
  Eigen::Matrix<double, 6, 1> with_best_sources(const Eigen::Vector4d& y) {
    Eigen::Matrix<double, 6, 1> p;
    p << y, 0.0, 0.0;
    for (int l = 0; l < 2; ++l) p[4 + l] = window().source(l, polar_.to_cartesian(y), polar_.origin_s()).frequency_hz;
    return p;
  }

  testing::BearingFrequencyWindows windows_;
  ModifiedPolar polar_;
  DopplerTerm term_;
  Eigen::Vector4d y_;
};

TEST_F(DopplerTermTest, GradientIsThatOfTheCost) {
  const auto cost = [&](const Eigen::Vector4d& y) { return Eigen::Matrix<double, 1, 1>(share(y).cost); };
  const Eigen::Matrix<double, 1, 4> numeric = testing::central_differences(cost, y_, kSteps);
  const Eigen::Vector4d gradient = share(y_).gradient;
  for (int i = 0; i < 4; ++i) EXPECT_NEAR(-gradient[i] / numeric[i], 1.0, kJacobian) << i;
}

TEST_F(DopplerTermTest, IsWhatIsLeftOfAllParametersWhenTheSourcesAreFitted) {
  const NormalEquations<6> all = whole(with_best_sources(y_), false);
  const NormalEquations<4> left = share(y_);
  EXPECT_NEAR(left.cost / all.cost, 1.0, 1e-9);
  EXPECT_LT(all.gradient.tail<2>().norm(), 1e-6);  // the sources are at their best
  const Eigen::Matrix<double, 4, 2> coupling = all.A.topRightCorner<4, 2>();
  const Eigen::Matrix4d expected =
      all.A.topLeftCorner<4, 4>() -
      coupling * all.A.bottomRightCorner<2, 2>().diagonal().cwiseInverse().asDiagonal() * coupling.transpose();
  for (int i = 0; i < 4; ++i) {
    EXPECT_NEAR(left.gradient[i] / all.gradient[i], 1.0, kJacobian) << i;
    for (int j = 0; j < 4; ++j)
      EXPECT_NEAR(left.A(i, j), expected(i, j), kJacobian * std::sqrt(expected(i, i) * expected(j, j))) << i << j;
  }
}

TEST_F(DopplerTermTest, MinimumIsThatOfAllParameters) {
  const auto projected = [&](const Eigen::Vector4d& y) {
    NormalEquations<4> equations = polar_(y);
    term_.add(y, equations);
    return equations;
  };
  const auto full = [&](const Eigen::Matrix<double, 6, 1>& p) { return whole(p, true); };
  LevenbergMarquardtOptions<6> options;
  options.max_iterations = 1000;
  const Minimum<4> few = levenberg_marquardt(projected, y_);
  const Minimum<6> all = levenberg_marquardt(full, with_best_sources(y_), options);
  ASSERT_EQ(few.convergence, Convergence::converged);
  EXPECT_NEAR(few.at.cost, all.at.cost, 1e-6);
  EXPECT_LT((with_best_sources(few.x).tail<2>() - all.x.tail<2>()).norm(), 1e-5);
  EXPECT_NEAR(few.x[3] / all.x[3], 1.0, 1e-4);
}

TEST_F(DopplerTermTest, ALevelOfOneFrequencySaysNothing) {
  std::vector<int> level(window().size());
  for (std::size_t i = 0; i < level.size(); ++i) level[i] = static_cast<int>(i);
  window().set_levels(level);
  term_.look_at(polar_, &window());
  const NormalEquations<4> before = polar_(y_);
  NormalEquations<4> equations = before;
  term_.add(y_, equations);
  EXPECT_EQ(term_.degrees_of_freedom(), 0u);
  EXPECT_NEAR(equations.cost, before.cost, 1e-9 * before.cost);
  EXPECT_LT((equations.A - before.A).norm(), 1e-9 * before.A.norm());
}

TEST_F(DopplerTermTest, WithoutFrequenciesThereIsNoShare) {
  term_.look_at(polar_, nullptr);
  EXPECT_TRUE(term_.empty());
  EXPECT_EQ(share(y_).cost, 0.0);
}

TEST_F(DopplerTermTest, TargetAtTheSensorIsNotFinite) {
  BearingWindow bearings;
  DopplerWindow frequencies;
  for (int k = 0; k < 5; ++k) {
    bearings.add(k, 0.0, 0.02, {0.0, 0.0});
    frequencies.add(k, 100.0, 0.02, {});
  }
  polar_.look_at(bearings);
  term_.look_at(polar_, &frequencies);
  EXPECT_FALSE(share({0.0, 0.0, 0.5, 1e-3}).is_finite());  // through the sensor two seconds ago
}

}  // namespace
}  // namespace truebearing::doppler_term_test
