// SPDX-License-Identifier: Apache-2.0
// The Fisher information of the angles theta (N) and log powers l (N) of N uncorrelated signals in one interval of a
// line array, the noise power known and 1: of Ns snapshots of covariance R = sum_n snr_n a_n a_n' + I it is (Stoica and
// Nehorai 1990)
//     J(x, y) = Ns tr(R^-1 dR/dx R^-1 dR/dy)
// For bounds: written to be read, with complex matrices. angle_likelihood.hpp has the same for trackers.
#pragma once

#include <Eigen/Core>
#include <span>

#include "truebearing/array/line_array.hpp"

namespace truebearing {

struct AngleInformation {
  Eigen::MatrixXd angles;       ///< J(theta, theta), rad^-2 (N x N)
  Eigen::MatrixXd angle_power;  ///< J(theta, l), rad^-1 (N x N)
  Eigen::MatrixXd powers;       ///< J(l, l) (N x N)

  /// What is known of the angles where the powers are: J(theta, theta).
  const Eigen::MatrixXd& powers_known() const { return angles; }
  /// Where they are not: J(theta, theta) - J(theta, l) J(l, l)^-1 J(l, theta).
  Eigen::MatrixXd powers_unknown() const;

  /// The Cramer-Rao bound of each angle, powers unknown, rad^2 (N); infinite for an angle that the interval does not
  /// determine, as of two signals that come from one.
  Eigen::VectorXd angle_variances_rad2() const;
};

/// angles_rad, snr (N): the latter is a signal's power over that of a sensor's noise. live (M): 0 for a sensor that
/// hears nothing; empty where all do.
AngleInformation angle_information(const LineArray& array, const Eigen::VectorXd& angles_rad,
                                   const Eigen::VectorXd& snr, int snapshots, std::span<const double> live = {});

}  // namespace truebearing
