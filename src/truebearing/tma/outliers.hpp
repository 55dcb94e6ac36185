// SPDX-License-Identifier: Apache-2.0
// Measurements that do not belong to their neighbours, whatever the estimate is worth that their residuals are about:
// each normalised residual is held against the median of the eight around it, so that neither a slow misfit (of a
// target that manoeuvred, say) nor a few outliers among the eight hide it or make one.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "truebearing/tma/batch_estimate.hpp"
#include "truebearing/tma/bearing_window.hpp"

namespace truebearing {

struct Outlier {
  std::size_t at;  ///< its place
  double sigmas;   ///< off its neighbours, or off what the others say of it; positive where it is too large
  /// Another that may be the outlier in its stead: by a likelihood ratio (2 ln) that chance passes once in a hundred
  /// times they cannot be told apart.
  std::optional<std::size_t> or_else{};
};

/// Allocates only where there are more residuals than ever before. What it returns holds until the next call.
class OutlierSearch {
 public:
  /// Of residuals in order of time, in units of their standard deviations or, where most are larger than that, of what
  /// is usual among them. Good residuals are called outliers in less than one list of a thousand. None in fewer than
  /// nine.
  std::span<const Outlier> operator()(std::span<const double> residuals);
  /// Of the bearings about an estimate.
  std::span<const Outlier> operator()(const BearingWindow& window, const BatchEstimate& estimate);

 private:
  std::vector<double> residuals_, off_, sizes_;
  std::vector<Outlier> outliers_;
};

/// Their places.
std::vector<std::size_t> places(std::span<const Outlier> outliers);

}  // namespace truebearing
