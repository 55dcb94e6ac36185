// What the residuals of a batch estimate say of its assumptions: are they as large as their standard deviations, are
// they white, and did the target change its velocity inside the window? The last by a score test for a change at each
// of a number of times: the residuals are projected on what the change would do to them, after what the four parameters
// (and the f0s of the source) can take of that. Its statistic is chi-square with two degrees of freedom where there was
// no change.
#pragma once

#include "truebearing/tma/batch_estimate.hpp"
#include "truebearing/tma/bearing_window.hpp"
#include "truebearing/tma/doppler_window.hpp"

namespace truebearing {

struct ResidualChecks {
  double chi_square = 0.0;  ///< sum of squared normalised residuals
  int degrees_of_freedom = 0;
  double lag_one = 0.0;      ///< autocorrelation at lag one times sqrt(m): N(0, 1) where they are white
  double manoeuvre = 0.0;    ///< largest score over the times that were looked at
  double manoeuvre_s = 0.0;  ///< the time it belongs to

  bool fits = true;         ///< chi_square below its 99.9 % quantile
  bool white = true;        ///< |lag_one| below its 99.9 % quantile
  bool manoeuvred = false;  ///< the largest score would come by chance in less than one window of a thousand
};

/// `estimate` must have been made from `window`, of five bearings or more, and from `frequencies` where given.
ResidualChecks check_residuals(const BearingWindow& window, const BatchEstimate& estimate,
                               const DopplerWindow* frequencies = nullptr);

}  // namespace truebearing
