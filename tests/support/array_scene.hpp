// SPDX-License-Identifier: Apache-2.0
// What a line array hears of targets that are written down: exact covariances, and intervals drawn from them.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <complex>
#include <vector>

#include "truebearing/array/interval.hpp"
#include "truebearing/array/line_array.hpp"
#include "truebearing/core/angle.hpp"
#include "truebearing/core/random.hpp"

namespace truebearing::testing {

using Snapshots = std::vector<std::complex<double>>;  // [t * sensors + m]

inline std::complex<double> complex_normal(RandomStream& random) {  // of power 1
  const double re = random.normal();
  return std::complex<double>(re, random.normal()) / std::sqrt(2.0);
}

/// a(theta) by equation (5).
inline Eigen::VectorXcd steering(const LineArray& array, double angle_rad) {
  Eigen::VectorXcd a(array.sensors);
  for (int m = 0; m < array.sensors; ++m)
    a[m] = std::exp(std::complex<double>(0.0, 2.0 * kPi * array.spacing_wavelengths * m * std::sin(angle_rad)));
  return a;
}

struct ArrayScene {
  std::vector<double> angles_rad;
  std::vector<double> powers;  // one for each angle
  double noise_power = 1.0;
  int sensors = 15;
  int snapshots = 30;
  double spacing_wavelengths = 0.5;
  std::vector<double> rates_radps{};  // where they move: so that the angles are those at the end of an interval of 1 s

  LineArray array() const { return {sensors, spacing_wavelengths}; }

  /// sum p a a^H + sigma^2 I
  Eigen::MatrixXcd covariance() const {
    Eigen::MatrixXcd R = noise_power * Eigen::MatrixXcd::Identity(sensors, sensors);
    for (std::size_t n = 0; n < angles_rad.size(); ++n) {
      const Eigen::VectorXcd a = steering(array(), angles_rad[n]);
      R += powers[n] * a * a.adjoint();
    }
    return R;
  }

  Snapshots draw(RandomStream& random) const {
    Snapshots values;
    for (int t = 0; t < snapshots; ++t) {
      const double time_s = -(snapshots - 1.0 - t) / snapshots;
      Eigen::VectorXcd r(sensors);
      for (std::complex<double>& value : r) value = std::sqrt(noise_power) * complex_normal(random);
      for (std::size_t n = 0; n < angles_rad.size(); ++n) {
        const double moved_rad = rates_radps.empty() ? 0.0 : time_s * rates_radps[n];
        r += std::sqrt(powers[n]) * complex_normal(random) * steering(array(), angles_rad[n] + moved_rad);
      }
      values.insert(values.end(), r.begin(), r.end());
    }
    return values;
  }

  SnapshotBlock block(const Snapshots& values) const { return {values, sensors, spacing_wavelengths, 1.0}; }

  /// The interval itself owns what it took.
  Interval interval(const Snapshots& values) const {
    Interval taken;
    taken.take(block(values));
    return taken;
  }
  Interval draw_interval(RandomStream& random) const { return interval(draw(random)); }
};

/// Targets of equal power, 10 dB above a noise of 1, at those angles in degrees.
inline ArrayScene scene_of(const std::vector<double>& angles_deg, double power = 10.0) {
  ArrayScene scene;
  for (const double angle : angles_deg) scene.angles_rad.push_back(radians(angle));
  scene.powers.assign(angles_deg.size(), power);
  return scene;
}

/// A complex matrix of its parts, the first `rows` of them.
inline Eigen::MatrixXcd joined(const SplitMatrix<double>& W, Eigen::Index rows) {
  Eigen::MatrixXcd joined(rows, W.cols());
  joined.real() = W.re.topRows(rows);
  joined.imag() = W.im.topRows(rows);
  return joined;
}
inline SplitMatrix<double> split(const Eigen::MatrixXcd& W) {
  return {W.real(), W.imag()};
}

}  // namespace truebearing::testing
