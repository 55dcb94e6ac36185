// SPDX-License-Identifier: Apache-2.0
// What a range rate's second derivatives make of an uncertain state, for filters that linearise it: of x ~ N(x, P) and
//     rate(x) = u . w,  u = p / |p|, w = v - v_site, of a place p from the site,
// the mean is rate(x) + tr(B P) / 2 and the variance grows by tr(B P B P) / 2, B the second derivatives at x:
//     d2 rate / dp dv = (I - u u') / |p|,  d2 rate / dp dp = -(t u' + u t' + (u . w)(I - u u')) / |p|^2,  t = (I - u u') w
// A velocity across the sight that is not known, 500 m/s, and a bearing of 0.3 degrees are 2.6 m/s of range rate, of which
// the first derivatives at a velocity of zero know nothing. Bar-Shalom, Li and Kirubarajan 2001, section 10.3.3.
#pragma once

#include <Eigen/Core>

#include "truebearing/measurement/range_bearing_rate.hpp"

namespace truebearing {

struct RangeRateCurvature {
  double mean_mps = 0.0;        ///< to be added to what is expected
  double variance_m2ps2 = 0.0;  ///< to be added to that of the errors
};

/// Zero at the site itself.
inline RangeRateCurvature range_rate_curvature(const RangeBearingRate<>& seen, const Eigen::Vector4d& x,
                                               const Eigen::Matrix4d& P) {
  const Eigen::Vector2d offset_m = x.head<2>() - seen.site_m, w = x.tail<2>() - seen.site_velocity_mps;
  const double range_m = offset_m.norm();
  if (!(range_m > 0.0)) return {};
  const Eigen::Vector2d u = offset_m / range_m;
  const Eigen::Matrix2d across = Eigen::Matrix2d::Identity() - u * u.transpose();
  const Eigen::Vector2d t = across * w;
  const double rate = u.dot(w);
  Eigen::Matrix4d B;
  B.topLeftCorner<2, 2>() = -(t * u.transpose() + u * t.transpose() + rate * across) / (range_m * range_m);
  B.topRightCorner<2, 2>() = B.bottomLeftCorner<2, 2>() = across / range_m;
  B.bottomRightCorner<2, 2>().setZero();
  const Eigen::Matrix4d BP = B * P;
  return {0.5 * BP.trace(), 0.5 * BP.cwiseProduct(BP.transpose()).sum()};
}

}  // namespace truebearing
