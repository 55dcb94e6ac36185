// SPDX-License-Identifier: Apache-2.0
// The covariance head of residual moments: each rule holds Sigma_j (p x p), the phi-weighted mean over training rows of
// e e' with e the error of the corrected estimate, normalised. Closed form. At an input the covariance is
// sum_j phi_j Sigma_j, positive semi-definite since the phi_j are a partition of one.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "truebearing/correction/fuzzy_network.hpp"

namespace truebearing {

/// Sigma (M x p p), a matrix to a row, from features (N x d, raw) and normalised errors e (N x p). With `output_parity`
/// (p) the rules are in mirror pairs, the second half mirroring the first, and so are their moments. A rule whose usage
/// (mean phi) is below `usage_floor` has too little to go by and gets the moments of all rows. Throws InputError for no
/// rows, other shapes or numbers that are not finite.
Eigen::MatrixXd covariance_moments(const FuzzyNetwork& network, const Eigen::MatrixXd& features,
                                   const Eigen::MatrixXd& errors, const std::vector<int>& output_parity = {},
                                   double usage_floor = 1e-3);

}  // namespace truebearing
