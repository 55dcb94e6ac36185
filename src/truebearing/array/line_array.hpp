// SPDX-License-Identifier: Apache-2.0
// A uniform line array: M sensors, neighbours `spacing_wavelengths` apart. Angles are from broadside, in radians.
//     a(theta) (M): exp(j 2 pi d/lambda (m - 1) sin theta), Ryu, Lee and Lee 2001, equation (5)
//     b(theta) = d a / d theta (M), equation (10)
// Complex columns are kept as their real and imaginary parts, which is what SIMD loops want.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <string>

#include "truebearing/core/angle.hpp"

namespace truebearing {

/// Real and imaginary parts of a complex matrix.
template <typename Real>
struct SplitMatrix {
  using Matrix = Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic>;
  Matrix re, im;

  void setZero(Eigen::Index rows, Eigen::Index columns) {
    re.setZero(rows, columns);
    im.setZero(rows, columns);
  }
  Eigen::Index rows() const { return re.rows(); }
  Eigen::Index cols() const { return re.cols(); }
};

struct LineArray {
  int sensors = 0;
  double spacing_wavelengths = 0.5;

  /// Phase from one sensor to the next, for a target at that angle.
  double phase_step(double angle_rad) const { return 2.0 * kPi * spacing_wavelengths * std::sin(angle_rad); }

  /// What two targets at the same range of sines have to differ by to be told apart by a beam: lambda / (M d), half the
  /// width of its main lobe between nulls.
  double resolution_sine() const { return 1.0 / (spacing_wavelengths * sensors); }

  /// What a user has to know of angles that this array tells, a sentence; empty where there is nothing.
  std::string note() const;

  /// Their distance in resolutions.
  double distance(double first_rad, double second_rad) const {
    return (std::sin(second_rad) - std::sin(first_rad)) / resolution_sine();
  }

  /// Column n of a and b at that angle; rows beyond the sensors are left alone.
  template <typename Real>
  void steer(double angle_rad, Eigen::Index n, SplitMatrix<Real>& a, SplitMatrix<Real>& b) const {
    const double step = phase_step(angle_rad);
    const double turn = 2.0 * kPi * spacing_wavelengths * std::cos(angle_rad);
    const double c1 = std::cos(step), s1 = std::sin(step);
    double c = 1.0, s = 0.0;
    for (int m = 0; m < sensors; ++m) {
      a.re(m, n) = Real(c);
      a.im(m, n) = Real(s);
      b.re(m, n) = Real(-turn * m * s);
      b.im(m, n) = Real(turn * m * c);
      const double next = c * c1 - s * s1;
      s = c * s1 + s * c1;
      c = next;
    }
  }
};

}  // namespace truebearing
