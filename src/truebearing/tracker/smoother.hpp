// SPDX-License-Identifier: Apache-2.0
// A tracker that looks back: told of all measurements of a run (foresee), each step says what they all, or those of a
// lag, make of the state there; and how much more that is than its filter knew. Not told of them, it is the filter.
#pragma once

#include "truebearing/core/bounded.hpp"
#include "truebearing/core/constants.hpp"
#include "truebearing/tracker/tracker.hpp"

namespace truebearing {

/// What a smoother knows of one of its steps beside the record.
struct SmoothingAccount {
  bool looked_back = false;       ///< else the record is the filter's own
  BoundedVector filter_variance;  ///< (n), the diagonal of P as the filter published it
  double nis = kNaN;              ///< of the filter's innovation, where it had one
  int measured = 0;               ///< its components
};

class Smoother : public Tracker {
 public:
  /// Of the last step, where it has a record.
  virtual const SmoothingAccount* account() const = 0;
};

}  // namespace truebearing
