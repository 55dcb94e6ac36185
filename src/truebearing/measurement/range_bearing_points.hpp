// SPDX-License-Identifier: Apache-2.0
// What RangeBearing expects of many states at once, for filters that go through points.
#pragma once

namespace truebearing {

/// residuals(:, i) = residual(h(x_i), z_0) of RangeBearing (2 x count, by columns), bearings within 5e-16 rad of h's
/// own. x_i begins i stride numbers after X; at most kMostPoints of them.
void range_bearing_residuals(const double* X, int stride, int count, const double* site_m, const double* z_0,
                             double* residuals);

inline constexpr int kMostPoints = 24;

}  // namespace truebearing
