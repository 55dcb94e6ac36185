// SPDX-License-Identifier: Apache-2.0
#include "truebearing/correction/correction_model.hpp"

#include <fmt/format.h>

#include "truebearing/core/covariance.hpp"
#include "truebearing/core/error.hpp"

namespace truebearing {
namespace {

void require(bool valid, const char* where, const std::string& found, const std::string& wanted) {
  if (!valid) throw InputError(where, found, wanted);
}

}  // namespace

BoundedMatrix CorrectionModel::head_covariance(const FuzzyNetwork::Strengths& phi, const BoundedMatrix& P) const {
  if (!design.covariance_moments) return phi.dot(inflation) * P;
  const Eigen::Index n = P.rows();
  const BoundedVector sigma = P.diagonal().cwiseSqrt();
  BoundedMatrix mean(n, n);
  for (Eigen::Index j = 0; j < n; ++j)
    for (Eigen::Index i = j; i < n; ++i)
      mean(i, j) = mean(j, i) = sigma[i] * sigma[j] * phi.dot(moments.col(i + n * j));
  return mean;
}

void CorrectionModel::validate() const {
  const auto d = static_cast<Eigen::Index>(design.features.size());
  const Eigen::Index M = network.rules();
  const Eigen::Index n = space ? space->size() : 0;
  require(n > 0, "state", "has no components", "a state space");
  require(network.inputs() == d, "features",
          fmt::format("{} of them for a network with {} inputs", d, network.inputs()), "one feature per input");
  require(network.outputs() == n, "rules", fmt::format("consequents of {} numbers", network.outputs()),
          fmt::format("{}, one per component of the state", n));
  require(!design.base.empty() && !design.reference.empty() && !design.covariance_of.empty(), "trackers",
          "a name is empty", "names of base, reference and covariance_of");
  space_in(design.frame, *space);
  if (!design.covariance_moments) {
    require(moments.size() == 0, "moments", "stand beside inflation", "one of the two");
    require(inflation.size() == M && inflation.allFinite() && (inflation.array() > 0.0).all(), "inflation",
            fmt::format("holds {} numbers, or one that is not > 0", inflation.size()),
            fmt::format("{} numbers > 0", M));
  } else {
    require(inflation.size() == 0, "inflation", "stands beside moments", "one of the two");
    require(moments.rows() == M && moments.cols() == n * n, "moments",
            fmt::format("is {} x {}", moments.rows(), moments.cols()), fmt::format("{} x {}", M, n * n));
    for (Eigen::Index j = 0; j < M; ++j)
      require(is_covariance(BoundedMatrix(moments.row(j).reshaped(n, n))), "moments",
              fmt::format("of rule {} are no covariance", j), "symmetric positive semi-definite matrices");
  }
  require(usage.size() == M && usage.allFinite(), "usage", fmt::format("holds {} numbers", usage.size()),
          fmt::format("{} finite numbers", M));
  require(local_mean.rows() == M && local_mean.cols() == n && local_mean.allFinite(), "local_mean",
          fmt::format("is {} x {}", local_mean.rows(), local_mean.cols()), fmt::format("{} x {} finite numbers", M, n));
  if (gate) {
    require(gate->low.size() == d && gate->high.size() == d && gate->low.allFinite() && gate->high.allFinite() &&
                (gate->low.array() <= gate->high.array()).all(),
            "gate", "low and high do not make a box", fmt::format("{} finite numbers each, low <= high", d));
    require(gate->largest_disagreement > 0.0, "gate.largest_disagreement",
            fmt::format("is {}", gate->largest_disagreement), "a number > 0, or null for none");
    require(gate->disagreement_edge_fraction > 0.0 && gate->disagreement_edge_fraction <= 10.0,
            "gate.disagreement_edge_fraction", fmt::format("is {}", gate->disagreement_edge_fraction),
            "a number in (0, 10]");
    require(gate->edge_fraction > 0.0 && gate->edge_fraction <= 10.0, "gate.edge_fraction",
            fmt::format("is {}", gate->edge_fraction), "a number in (0, 10]");
    const IntervalBox& intervals = gate->intervals;
    require(
        intervals.low_s >= 0.0 && intervals.low_s <= intervals.high_s && intervals.longest_coast_s >= 0.0,
        "gate.intervals",
        fmt::format("are {} to {} s, a coast of {} s", intervals.low_s, intervals.high_s, intervals.longest_coast_s),
        "0 <= low_s <= high_s, longest_coast_s >= 0");
  }
}

}  // namespace truebearing
