// SPDX-License-Identifier: Apache-2.0
// k-means by Lloyd's iteration from k-means++ seeds (Arthur and Vassilvitskii 2007): where the rules of a scattered
// fuzzy network start. Points (N x d), centres (k x d).
#pragma once

#include <Eigen/Core>

#include "truebearing/core/random.hpp"

namespace truebearing {

struct KMeansOptions {
  int iterations = 30;              ///< at most; ends earlier when no point changes its centre
  Eigen::Index max_points = 20000;  ///< of a larger set, a stratified sample is clustered
};

/// Centres (k x d) of the points (N x d). Throws InputError where N < count or count < 1. A function of the arguments
/// and the stream's state alone.
Eigen::MatrixXd k_means(const Eigen::MatrixXd& points, int count, RandomStream& random,
                        const KMeansOptions& options = {});

}  // namespace truebearing
