// SPDX-License-Identifier: Apache-2.0
// A tracker that goes on from another's estimate: a filter that a batch estimate begins.
#pragma once

#include "truebearing/tracker/tracker.hpp"

namespace truebearing {

class Successor : public Tracker {
 public:
  /// Begins anew with x (k), P (k x k) at time_s: the first k components of its state, the others as its start says.
  /// What came before time_s must be in x; measurements from there on are to come.
  virtual void take_over(double time_s, const BoundedVector& x, const BoundedMatrix& P) = 0;

  /// There is no track, or none that the next measurement will go on with: it has been given up.
  virtual bool is_lost() const = 0;
};

}  // namespace truebearing
