// SPDX-License-Identifier: Apache-2.0
#include "truebearing/array/angle_information.hpp"

#include <array>
#include <limits>

#include "truebearing/core/linear_algebra.hpp"

namespace truebearing {

Eigen::MatrixXd AngleInformation::powers_unknown() const {
  // Least squares: J(l, l) is singular where two signals come from one angle, of which only the sum can be heard.
  const Eigen::MatrixXd known = angle_power * least_squares(powers, angle_power.transpose());
  return angles - 0.5 * (known + known.transpose());
}

Eigen::VectorXd AngleInformation::angle_variances_rad2() const {
  constexpr double kRounding = 1e-10;
  const Eigen::MatrixXd J = powers_unknown();
  const Eigen::VectorXd scale = angles.diagonal().array().rsqrt();
  const auto modes = symmetric_modes<Eigen::Dynamic>(scale.asDiagonal() * J * scale.asDiagonal());
  Eigen::VectorXd variances = Eigen::VectorXd::Zero(J.rows());
  for (Eigen::Index n = 0; n < J.rows(); ++n)
    for (Eigen::Index mode = 0; mode < J.rows(); ++mode) {
      const double part = scale[n] * modes.vectors(n, mode), heard = modes.values[mode];
      if (heard > kRounding)
        variances[n] += part * part / heard;
      else if (part * part > kRounding * scale[n] * scale[n])
        variances[n] = std::numeric_limits<double>::infinity();
    }
  return variances;
}

AngleInformation angle_information(const LineArray& array, const Eigen::VectorXd& angles_rad,
                                   const Eigen::VectorXd& snr, int snapshots, std::span<const double> live) {
  const Eigen::Index N = angles_rad.size(), M = array.sensors;
  SplitMatrix<double> a, d;
  a.setZero(M, N);
  d.setZero(M, N);
  for (Eigen::Index n = 0; n < N; ++n) array.steer(angles_rad[n], n, a, d);
  Eigen::MatrixXcd A(M, N), D(M, N);
  A.real() = a.re, A.imag() = a.im;
  D.real() = d.re, D.imag() = d.im;
  if (!live.empty()) {
    const Eigen::Map<const Eigen::VectorXd> hears(live.data(), M);
    A = (hears.asDiagonal() * A).eval();
    D = (hears.asDiagonal() * D).eval();
  }
  const Eigen::MatrixXcd R = A * snr.asDiagonal() * A.adjoint() + Eigen::MatrixXcd::Identity(M, M);
  std::array<Eigen::MatrixXcd, 2> solved{A, D};
  solve_positive_in_place(R, solved);
  const auto& [RA, RD] = solved;
  const Eigen::MatrixXcd aRa = A.adjoint() * RA, dRa = D.adjoint() * RA, dRd = D.adjoint() * RD;

  // dR/dtheta_i = p_i (d_i a_i' + a_i d_i'),  dR/dl_i = p_i a_i a_i'
  AngleInformation J{Eigen::MatrixXd(N, N), Eigen::MatrixXd(N, N), Eigen::MatrixXd(N, N)};
  for (Eigen::Index j = 0; j < N; ++j)
    for (Eigen::Index i = 0; i < N; ++i) {
      const double pp = snapshots * snr[i] * snr[j];
      const std::complex<double> a_j_d_i = std::conj(dRa(i, j)), a_i_d_j = std::conj(dRa(j, i));
      J.angles(i, j) = 2.0 * pp * (a_j_d_i * a_i_d_j + std::conj(dRd(i, j)) * aRa(i, j)).real();
      J.angle_power(i, j) = 2.0 * pp * (a_j_d_i * aRa(i, j)).real();
      J.powers(i, j) = pp * std::norm(aRa(i, j));
    }
  return J;
}

}  // namespace truebearing
