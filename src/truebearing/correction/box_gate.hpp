// The box gate: how far the inputs of a network lie inside the box that its training data filled. The worst input decides.
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

  bool operator==(const BoxGate&) const = default;

  /// g in [0, 1]: 1 inside the box, falling as exp(-excess^2 / 2) outside, the excess measured in edge widths; 0 for an
  /// input that is not finite.
  double weight(const FuzzyNetwork::Inputs& inputs) const {
    double worst = 0.0;
    for (Eigen::Index i = 0; i < low.size(); ++i) {
      const double outside = std::max({low[i] - inputs[i], inputs[i] - high[i], 0.0});
      if (!std::isfinite(inputs[i])) return 0.0;
      if (outside > 0.0) worst = std::max(worst, outside / (edge_fraction * (high[i] - low[i])));
    }
    return std::exp(-0.5 * worst * worst);
  }
};

}  // namespace truebearing
