// SPDX-License-Identifier: Apache-2.0
// What target-motion analysis can find at best, by the information of the bearings and frequencies at the truth: outliers
// by their leverage, a change of velocity by the power of the likelihood ratio's test.
#pragma once

#include <algorithm>
#include <boost/math/distributions/non_central_chi_squared.hpp>
#include <boost/math/distributions/normal.hpp>
#include <cmath>
#include <vector>

#include "truebearing/core/linear_algebra.hpp"
#include "truebearing/tma/motion_rows.hpp"
#include "truebearing/tma/outlier_deletion.hpp"

namespace truebearing::testing {

/// Of each outlier of `sigmas` the chance to be found, the others known: its deleted residual, about
/// D = sigmas sqrt(1 - h) with standard deviation 1, passes the limit, and is larger than that of the bearing that is
/// most like it: the difference of two with correlation rho is D (1 - |rho|), of variance 2 (1 - |rho|).
/// `truth`: x at time_s.
inline double outliers_to_be_found(const BearingWindow& bearings, const DopplerWindow* frequencies,
                                   const BatchEstimate& truth, const std::vector<std::size_t>& outliers,
                                   double sigmas) {
  constexpr std::size_t kParameters = 4;
  if (outliers.empty() || outliers.size() + kParameters >= bearings.size()) return 0.0;
  const boost::math::normal normal;
  const double limit = OutlierDeletion(bearings, nullptr).limit();
  MotionRows rows(bearings, frequencies);
  rows.look_at(polar_of(truth, rows.polar()));
  const auto of_y = [](const MotionRow& row) { return row.of_y; };
  Eigen::Matrix4d good = rows.equations<4>(of_y).A;
  std::vector<bool> is_good(bearings.size(), true);
  for (const std::size_t i : outliers) {
    is_good[i] = false;
    good -= rows.bearings()[i].of_y.transpose() * rows.bearings()[i].of_y;
  }
  double expected = 0.0;
  for (const std::size_t i : outliers) {
    const Eigen::RowVector4d j = rows.bearings()[i].of_y;
    const Eigen::Matrix4d P = inverse_of_what_is_known(good + j.transpose() * j);
    const double left = std::max(1.0 - j.dot(j * P), 0.0), shows = sigmas * std::sqrt(left);
    double likest = 0.0;
    for (std::size_t k = 0; k < bearings.size(); ++k) {
      if (!is_good[k]) continue;
      const Eigen::RowVector4d other = rows.bearings()[k].of_y;
      const double of_other = std::max(1.0 - other.dot(other * P), 1e-12);
      likest =
          std::max(likest, std::min(std::abs(j.dot(other * P)) / std::sqrt(std::max(left, 1e-12) * of_other), 1.0));
    }
    const double seen = cdf(normal, shows - limit), told_apart = cdf(normal, shows * std::sqrt(0.5 * (1.0 - likest)));
    expected += std::min(seen, told_apart);
  }
  return expected;
}

/// A change of velocity dv at change_s, the motion before it and the f0s unknown.
struct ChangeBound {
  double sigma_mps;     ///< standard deviation of the change in its own direction, its time known
  double found;         ///< chance that the test at level .001 over `times` times finds it
  double time_sigma_s;  ///< of its time
  double dated(double within_s) const { return std::erf(within_s / (std::sqrt(2.0) * time_sigma_s)); }
};
/// `before`: x at time_s of the motion before the change.
inline ChangeBound change_bound(const BearingWindow& bearings, const DopplerWindow* frequencies,
                                const BatchEstimate& before, const Eigen::Vector2d& dv_mps, double change_s,
                                double threshold) {
  MotionRows rows(bearings, frequencies);
  rows.look_at(polar_of(before, rows.polar()), dv_mps, change_s);
  const Eigen::Matrix<double, 7, 7> A = rows.equations<7>([&](const MotionRow& row) {
                                              Eigen::Matrix<double, 1, 7> j;
                                              // The time: a later change has moved the target by dv less for each second.
                                              j << row.of_y, row.of_change(change_s),
                                                  row.time_s > change_s ? -row.of_place.dot(dv_mps) : 0.0;
                                              return j;
                                            })
                                            .A;
  const auto left_of = [&](Eigen::Index count) -> Eigen::MatrixXd {
    const Eigen::Matrix4d P = inverse_of_what_is_known(A.topLeftCorner<4, 4>());
    const Eigen::MatrixXd coupling = A.block(4, 0, count, 4);
    return A.block(4, 4, count, count) - coupling * P * coupling.transpose();
  };
  const double noncentrality = dv_mps.dot(left_of(2) * dv_mps);
  const boost::math::non_central_chi_squared law(2.0, std::max(noncentrality, 1e-9));
  const Eigen::MatrixXd with_time = inverse_of_positive(left_of(3));
  return {dv_mps.norm() / std::sqrt(noncentrality), cdf(complement(law, threshold)), std::sqrt(with_time(2, 2))};
}

}  // namespace truebearing::testing
