// SPDX-License-Identifier: Apache-2.0
// What a Doppler radar without a bearing measures of a state [east, north, v_east, v_north]: range rate alone, or range
// and range rate, from a site that may move. Rows of the model of all three (range_bearing_rate.hpp), with the
// correlation of range and range rate.
#pragma once

#include <Eigen/Core>

#include "truebearing/measurement/range_bearing_rate.hpp"

namespace truebearing {

/// z = the components kRows of [range_m, bearing_rad, range_rate_mps], without the bearing.
template <typename ScalarType, int... kRows>
requires((kRows != 1) && ...) struct RowsOfRangeBearingRate {
  using Scalar = ScalarType;
  static constexpr int kStates = 4;
  static constexpr int kMeasurements = sizeof...(kRows);
  using State = Eigen::Matrix<Scalar, kStates, 1>;
  using Vector = Eigen::Matrix<Scalar, kMeasurements, 1>;
  using Jacobian = Eigen::Matrix<Scalar, kMeasurements, kStates>;
  using Covariance = Eigen::Matrix<Scalar, kMeasurements, kMeasurements>;

  RangeBearingRate<Scalar> whole;  ///< its standard deviation of the bearing is not looked at

  Vector h(const State& x) const { return rows(whole.h(x)); }
  Jacobian H(const State& x) const { return rows(whole.H(x)); }
  Covariance R() const { return rows(rows(whole.R()).transpose().eval()); }
  Vector residual(const Vector& z, const Vector& z_pred) const { return z - z_pred; }

 private:
  template <typename Derived>
  static Eigen::Matrix<Scalar, kMeasurements, Derived::ColsAtCompileTime> rows(const Eigen::MatrixBase<Derived>& all) {
    constexpr int kPlaces[] = {kRows...};
    Eigen::Matrix<Scalar, kMeasurements, Derived::ColsAtCompileTime> some;
    for (int i = 0; i < kMeasurements; ++i) some.row(i) = all.row(kPlaces[i]);
    return some;
  }
};

struct RangeRate : RowsOfRangeBearingRate<double, 2> {
  static Measured measured() { return {"range_rate", {"range_rate_mps"}}; }
};

struct RangeAndRate : RowsOfRangeBearingRate<double, 0, 2> {
  static Measured measured() { return {"range_range_rate", {"range_m", "range_rate_mps"}}; }
};

static_assert(MeasurementModel<RangeRate>);
static_assert(MeasurementModel<RangeAndRate>);
static_assert(MeasurementModel<RowsOfRangeBearingRate<float, 0, 2>>);

}  // namespace truebearing
