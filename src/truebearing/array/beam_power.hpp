// SPDX-License-Identifier: Apache-2.0
// The power of a conventional beam at each of some angles (Bartlett 1948; Van
// Trees 2002, sec. 2.5): what an operator's bearing-time display shows.
//     p(theta) = a(theta)^H R a(theta) / M^2
#pragma once

#include <Eigen/Core>
#include <vector>

#include "truebearing/array/line_array.hpp"

namespace truebearing {

/// p at each angle (radians from broadside), of the sample covariance R (M x M)
/// of one interval. A plane wave of power P alone gives P at its angle.
std::vector<double> beam_power(const LineArray& array, const Eigen::MatrixXcd& R,
                               const std::vector<double>& angles_rad);

}  // namespace truebearing
