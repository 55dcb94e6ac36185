// SPDX-License-Identifier: Apache-2.0
// CorrectionBounds: what keeps a correction within bounds while it runs. No part of it enters the training: it stands
// in the study, and changing it asks for no new model.
#pragma once

#include <limits>
#include <optional>
#include <string>

#include "truebearing/correction/referee.hpp"

namespace truebearing {

struct CorrectionBounds {
  double kappa = 3.0;                          ///< > 0, limit_kappa's; infinity: not limited
  bool gate = true;                            ///< whether the model's box closes the gate, where it has one
  std::optional<RefereeOptions> referee = {};  ///< absent: none
  /// A tracker that is trusted in the reference's place where the referee finds it the better one; empty: none.
  std::string fallback = {};
  /// > 0: at longer intervals between used measurements the gate closes, whatever was taught.
  double longest_interval_s = std::numeric_limits<double>::infinity();

  bool operator==(const CorrectionBounds&) const = default;

  /// Throws InputError where a number is out of range.
  void validate() const;
};

/// For people: "kappa 3, gate, no referee".
std::string describe(const CorrectionBounds& bounds);

}  // namespace truebearing
