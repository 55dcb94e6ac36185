// SPDX-License-Identifier: Apache-2.0
// What else bearings may be that no one course and speed explains: those of two contacts in one log, or all of them
// turned round (of the wrong end of a line array, or from the target to own ship).
#pragma once

#include <optional>
#include <vector>

#include "truebearing/tma/batch_estimate.hpp"
#include "truebearing/tma/bearing_window.hpp"

namespace truebearing {

struct TwoContacts {
  std::vector<bool> of_second;  ///< for each bearing
  std::size_t count[2];         ///< of bearings
  BatchEstimate estimate[2];
  double cost = 0.0;  ///< 1/2 the sum of squares that is left
};

/// Parts the bearings between two targets, each to the one that it fits better, until none changes its part. Begins
/// with those to either side of `one`, the least squares of all. Nothing where that does not end in residuals as they
/// should be (chi-square below its 99.9 % quantile), with a tenth of the bearings or more in either part, in turns.
std::optional<TwoContacts> find_two_contacts(const BearingWindow& window, const BatchEstimate& one);

/// The target that fits the bearings turned by 180 degrees, where it fits by a likelihood ratio of more than
/// Observability::kRuledOut better than `one` fits them as they are, and its range is determined.
std::optional<BatchEstimate> find_reversed(const BearingWindow& window, const BatchEstimate& one);

}  // namespace truebearing
