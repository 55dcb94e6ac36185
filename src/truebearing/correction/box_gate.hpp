// SPDX-License-Identifier: Apache-2.0
// The box gate: how far a step lies inside the box that the training data filled. The sides of the box are the
// network's inputs; the intervals at which the base used measurements; and the disagreement: the Mahalanobis distance
// between what the network wants and the reference, under the sum of the two covariances. A target that the inputs
// alone do not give away shows there: the network contradicts the trusted tracker as it never did in training. The
// worst side decides.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>

#include "truebearing/core/covariance.hpp"
#include "truebearing/correction/fuzzy_network.hpp"
#include "truebearing/correction/interval_memory.hpp"

namespace truebearing {

/// How far apart two estimates are, d (n), for what they claim, P_a and P_b (n x n): the root of d' (P_a + P_b)^-1 d.
/// NaN where that has no value.
template <typename DerivedD, typename DerivedA, typename DerivedB>
double disagreement(const Eigen::MatrixBase<DerivedD>& d, const Eigen::MatrixBase<DerivedA>& P_a,
                    const Eigen::MatrixBase<DerivedB>& P_b) {
  return std::sqrt(mahalanobis_squared(P_a + P_b, d));
}

/// The intervals that were taught, of the last few of a track (interval_memory.hpp) the shortest and the longest, and
/// the longest time that its base coasted.
struct IntervalBox {
  double low_s = 0.0;
  double high_s = std::numeric_limits<double>::infinity();
  double longest_coast_s = std::numeric_limits<double>::infinity();

  bool operator==(const IntervalBox&) const = default;

  /// How far outside, in edge widths of a tenth of the interval; 0 inside, and before there is an interval.
  double excess(const Intervals& found) const {
    constexpr double kEdge = 0.1;
    double worst = 0.0;
    if (found.shortest_s < low_s) worst = std::log(low_s / found.shortest_s) / kEdge;
    if (found.longest_s > high_s) worst = std::max(worst, std::log(found.longest_s / high_s) / kEdge);
    if (found.coast_s > longest_coast_s)
      worst = std::max(worst, (found.coast_s - longest_coast_s) / (kEdge * std::max(low_s, longest_coast_s)));
    return worst;
  }
};

struct BoxGate {
  Eigen::VectorXd low;         ///< (d), in the units of the features
  Eigen::VectorXd high;        ///< (d), low <= high
  double edge_fraction = 0.1;  ///< the Gaussian edge outside the box, as a share of the box's width
  /// That passes, > 0. Infinity where the reference is the base itself, which a correction is meant to contradict.
  double largest_disagreement = std::numeric_limits<double>::infinity();
  double disagreement_edge_fraction = 0.05;  ///< the edge beyond it, as a share of it
  IntervalBox intervals = {};

  bool operator==(const BoxGate&) const = default;

  /// g in [0, 1] for inputs (d), intervals and a disagreement: 1 inside the box, falling as exp(-excess^2 / 2) outside,
  /// the excess measured in edge widths; 0 where a number is not finite.
  double weight(const FuzzyNetwork::Inputs& inputs, const Intervals& found_intervals, double found_disagreement) const {
    double worst = intervals.excess(found_intervals);
    if (std::isfinite(largest_disagreement)) {
      if (!std::isfinite(found_disagreement)) return 0.0;
      worst = std::max(
          worst, (found_disagreement - largest_disagreement) / (disagreement_edge_fraction * largest_disagreement));
    }
    constexpr double kLeastWidth = 1e-6;  // of an input that was always the same, up to rounding
    double unknown = 0.0;                 // NaN where an input is not finite
    for (Eigen::Index i = 0; i < low.size(); ++i) {
      const double outside = std::max(low[i] - inputs[i], inputs[i] - high[i]);
      unknown += 0.0 * inputs[i];
      if (outside > 0.0) worst = std::max(worst, outside / (edge_fraction * std::max(high[i] - low[i], kLeastWidth)));
    }
    if (std::isnan(unknown)) return 0.0;
    return worst > 0.0 ? std::exp(-0.5 * worst * worst) : 1.0;
  }
};

}  // namespace truebearing
