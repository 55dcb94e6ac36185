// The box gate: how far a step lies inside the box that the training data filled. The sides of the box are the network's inputs, and the
// reach: how far from the reference, in its standard deviations, the network went on its training data. A family that the inputs
// alone do not give away shows there, where the network contradicts the trusted tracker more than it ever did. The worst side decides.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "truebearing/correction/fuzzy_network.hpp"

namespace truebearing {

struct BoxGate {
  Eigen::VectorXd low;         ///< (d), in the units of the features
  Eigen::VectorXd high;        ///< (d), low <= high
  double edge_fraction = 0.1;  ///< the Gaussian edge outside the box, as a share of the box's width
  double reach_sigmas = 0.0;   ///< > 0
  double reach_edge_fraction = 0.05;  ///< the edge outside the reach, as a share of the reach

  bool operator==(const BoxGate&) const = default;

  /// g in [0, 1] for inputs (d) and the Mahalanobis distance of the uncorrected reference from where the network wants to go: 1
  /// inside the box, falling as exp(-excess^2 / 2) outside, the excess measured in edge widths; 0 where a number is not finite.
  double weight(const FuzzyNetwork::Inputs& inputs, double distance_sigmas) const {
    if (!inputs.allFinite() || !std::isfinite(distance_sigmas)) return 0.0;
    double worst = std::max(distance_sigmas - reach_sigmas, 0.0) / (reach_edge_fraction * reach_sigmas);
    for (Eigen::Index i = 0; i < low.size(); ++i) {
      const double outside = std::max({low[i] - inputs[i], inputs[i] - high[i], 0.0});
      if (outside > 0.0) worst = std::max(worst, outside / (edge_fraction * (high[i] - low[i])));
    }
    return std::exp(-0.5 * worst * worst);
  }
};

}  // namespace truebearing
