// SPDX-License-Identifier: Apache-2.0
// The angles of N signals from the signal subspace of one interval, each interval by itself: what a tracker begins
// with.
//     MUSIC   peaks of 1 / |P_perp a(theta)|^2, on a grid and refined (Schmidt 1986)
//     ESPRIT  eigenvalues of the rotation from the first M - 1 sensors to the last M - 1, in the least-squares sense
//             (Roy and Kailath 1989); needs no grid and always gives N angles
// Angles are returned in ascending order, in (-pi/2, pi/2). These allocate: they are for beginnings.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "truebearing/array/line_array.hpp"

namespace truebearing {

/// At most N angles: two signals that the spectrum does not separate give one. E (M x N): orthonormal.
std::vector<double> music_angles(const LineArray& array, const Eigen::MatrixXcd& E, int grid = 721);

/// As many angles as E has columns.
std::vector<double> esprit_angles(const LineArray& array, const Eigen::MatrixXcd& E);

/// MUSIC's angles where it finds as many as E has columns, else ESPRIT's.
std::vector<double> signal_angles(const LineArray& array, const Eigen::MatrixXcd& E);

}  // namespace truebearing
