// SPDX-License-Identifier: Apache-2.0
// What else bearings may be that no one course and speed explains: those of two contacts in one log, or all of them
// turned round (of the wrong end of a line array, or from the target to own ship).
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "truebearing/tma/batch_estimate.hpp"
#include "truebearing/tma/bearing_window.hpp"
#include "truebearing/tma/outliers.hpp"

namespace truebearing {

struct TwoContacts {
  std::vector<bool> of_second;  ///< for each bearing
  std::size_t count[2];         ///< of bearings
  BatchEstimate estimate[2];
  double cost = 0.0;  ///< 1/2 the sum of squares that is left
};

/// Parts the bearings between two targets, each to the one that it fits better, until none changes its part. Begins
/// with `outliers` and the others where a tenth of them and more are that, then with those to either side of `one`, the
/// least squares of all, then with every second, until one of these ends in an answer: residuals as they should be
/// (chi-square below its 99.9 % quantile), with a tenth of the bearings or more in either part, in turns.
std::optional<TwoContacts> find_two_contacts(const BearingWindow& window, const BatchEstimate& one,
                                             std::span<const Outlier> outliers = {});

/// The target that fits the bearings turned by 180 degrees, where it fits by a likelihood ratio of more than
/// Observability::kRuledOut better than `one` fits them as they are, its range is determined, and what is left is
/// as it should be, outliers apart.
std::optional<BatchEstimate> find_reversed(const BearingWindow& window, const BatchEstimate& one);

}  // namespace truebearing
