// SPDX-License-Identifier: Apache-2.0
// How much wider than the filter says the corrected estimate's error is, learned per rule: s_j (M) is the phi-weighted
// mean over training rows of r = e' P^-1 e / n, the normalised squared error of the corrected estimate (1 for a
// consistent one). At an input the covariance is multiplied by sum_j phi_j s_j.
#pragma once

#include <Eigen/Core>

#include "truebearing/correction/fuzzy_network.hpp"

namespace truebearing {

/// s (M) from features (N x d, raw) and normalised squared errors r (N, >= 0). A rule whose usage (mean phi) is below
/// `usage_floor` has too little to go by and gets the mean of r over all rows. Throws InputError for no rows, other
/// shapes or numbers that are not finite.
Eigen::VectorXd covariance_inflation(const FuzzyNetwork& network, const Eigen::MatrixXd& features,
                                     const Eigen::VectorXd& normalised_squared_errors, double usage_floor = 1e-3);

}  // namespace truebearing
