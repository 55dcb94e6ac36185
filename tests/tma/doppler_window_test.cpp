// SPDX-License-Identifier: Apache-2.0
#include "truebearing/tma/doppler_window.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>

#include "tests/support/bearing_frequency_runs.hpp"
#include "tests/support/jacobian.hpp"
#include "truebearing/core/covariance.hpp"

namespace truebearing::doppler_window_test {
namespace {

using testing::jump;
using testing::KimSong;

constexpr double kJacobian = 1e-6, kAlgebra = 1e-12;
const Eigen::Vector4d kSteps(0.1, 0.1, 1e-3, 1e-3);
const Eigen::Vector4d kOther = KimSong::target(1050.0) + Eigen::Vector4d(500.0, -300.0, 0.7, -0.4);

Eigen::Matrix<double, 5, 1> with(const Eigen::Vector4d& x, double f0_hz) {
  Eigen::Matrix<double, 5, 1> whole;
  whole << x, f0_hz;
  return whole;
}

TEST(DopplerWindow, ShiftIsThatOfTheMeasurementModel) {
  const DopplerWindow window = KimSong::windows(0).frequencies;
  for (std::size_t i = 0; i < window.size(); i += 13) {
    Eigen::Vector4d x = kOther;
    x.head<2>() += (window.time_s(i) - 1050.0) * x.tail<2>();
    const SensorState& own = window.sensor(i);
    const BearingFrequency<> model{own.position_m, own.velocity_mps, 1.0, 1.0};
    EXPECT_NEAR(window.shift(i, kOther, 1050.0).value, model.h(with(x, 1.0))[1], kAlgebra);
  }
}

TEST(DopplerWindow, ShiftsDerivativeIsThatOfTheShift) {
  const DopplerWindow window = KimSong::windows(0).frequencies;
  for (const std::size_t i : {std::size_t{0}, std::size_t{70}, std::size_t{150}}) {
    const auto value = [&](const Eigen::Vector4d& x) {
      return Eigen::Matrix<double, 1, 1>(window.shift(i, x, 1050.0).value);
    };
    const Eigen::Matrix<double, 1, 4> expected = testing::central_differences(value, kOther, kSteps);
    EXPECT_LT((window.shift(i, kOther, 1050.0).per_state - expected).norm(), kJacobian * expected.norm()) << i;
  }
}

TEST(DopplerWindow, SourceIsTheFrequencyThatWasSent) {
  DopplerWindow window = KimSong::windows(0, jump(30.0, 600.0, 800.0), 0.0).frequencies;
  std::vector<int> level;
  for (std::size_t i = 0; i < window.size(); ++i)
    level.push_back(window.time_s(i) >= 600.0 && window.time_s(i) < 800.0);
  window.set_levels(level);
  const Eigen::Vector4d x = KimSong::target(1050.0);
  EXPECT_NEAR(window.source(0, x, 1050.0).frequency_hz, 100.0, 100.0 * kAlgebra);
  EXPECT_NEAR(window.source(1, x, 1050.0).frequency_hz, 130.0, 130.0 * kAlgebra);
  std::vector<SourceFrequency> all;
  window.sources(x, 1050.0, all);
  ASSERT_EQ(all.size(), 2u);
  EXPECT_EQ(all[1].frequency_hz, window.source(1, x, 1050.0).frequency_hz);
  EXPECT_EQ(all[1].per_state, window.source(1, x, 1050.0).per_state);
}

TEST(DopplerWindow, SourcesDerivativeIsThatOfTheSource) {
  const DopplerWindow window = KimSong::windows(0, jump(0.0), 0.0).frequencies;
  const Eigen::Vector4d x = KimSong::target(1050.0);
  const auto frequency = [&](const Eigen::Vector4d& at) {
    return Eigen::Matrix<double, 1, 1>(window.source(0, at, 1050.0).frequency_hz);
  };
  const Eigen::Matrix<double, 1, 4> expected = testing::central_differences(frequency, x, kSteps);
  EXPECT_LT((window.source(0, x, 1050.0).per_state - expected).norm(), kJacobian * expected.norm());
}

// Both the joint covariance from the five-by-five information and from the four-by-four one that is left of it.
TEST(DopplerWindow, CovarianceWithTheSourceIsTheInverseOfAllInformation) {
  const auto [bearings, window] = KimSong::windows(0);
  const Eigen::Vector4d x = KimSong::target(1050.0);
  const SourceFrequency source = window.source(0, x, 1050.0);
  Eigen::Matrix<double, 5, 5> information = Eigen::Matrix<double, 5, 5>::Zero();
  information.topLeftCorner<4, 4>() = bearings.cartesian(x, 1050.0).A;
  for (std::size_t i = 0; i < window.size(); ++i) {
    const DopplerWindow::Shift shift = window.shift(i, x, 1050.0);
    Eigen::Matrix<double, 1, 5> H;
    H << source.frequency_hz * shift.per_state, shift.value;
    information += window.weight(i) * H.transpose() * H;
  }
  const Eigen::Vector4d coupling = information.topRightCorner<4, 1>();
  const Eigen::Matrix4d left = information.topLeftCorner<4, 4>() - coupling * coupling.transpose() / information(4, 4);
  const Eigen::Matrix<double, 5, 5> P = covariance_with(left.inverse(), source);
  EXPECT_LT((P * information - Eigen::Matrix<double, 5, 5>::Identity()).norm(), kJacobian);
  EXPECT_TRUE(is_covariance(P));
  EXPECT_NEAR(std::sqrt(P(0, 0) + P(1, 1)), 155.0, 3.0);  // the bounds of Kim and Song's scenario
  EXPECT_NEAR(std::sqrt(P(2, 2) + P(3, 3)), 0.151, 0.003);
  EXPECT_NEAR(std::sqrt(P(4, 4)), 0.0072, 0.0002);
}

TEST(DopplerWindow, NumbersLevelsInTheirOrderAndDropsThoseThatAreGone) {
  DopplerWindow window;
  for (int i = 0; i < 6; ++i) window.add(i, 100.0, 0.02, {});
  EXPECT_EQ(window.levels(), 1);
  window.set_levels(std::vector<int>{7, 7, 2, 2, 7, 0});
  EXPECT_EQ(window.levels(), 3);
  EXPECT_EQ(window.level(0), 0);
  EXPECT_EQ(window.level(2), 1);
  EXPECT_EQ(window.level(5), 2);
  window.drop_before(5.0);
  EXPECT_EQ(window.levels(), 1);
  EXPECT_EQ(window.level(0), 0);
  window.drop_before(9.0);
  EXPECT_EQ(window.levels(), 0);
  EXPECT_EQ(window.size(), 0u);
}

}  // namespace
}  // namespace truebearing::doppler_window_test
