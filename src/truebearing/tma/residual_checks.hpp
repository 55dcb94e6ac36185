// SPDX-License-Identifier: Apache-2.0
// What the residuals of a batch estimate say of its assumptions: are they as large as their standard deviations, are
// they white, are there outliers among the bearings, did the target change its velocity inside the window, are all
// bearings off by a constant? However the estimate was made (maximum likelihood, with a prior, with Huber's loss, by a
// method that does not end at the minimum), what is asked is whether any one course and speed explains the bearings, so
// that all but the first sum is taken about the least-squares estimate, outliers left out.
//
// Chances, per window where nothing is wrong: a sum too large .001, too small .001; a correlation .001; an outlier .001;
// a constant error .001; a change of velocity .001. The last is the largest of K <= 40 statistics (velocity_change.hpp),
// each chi-square with two degrees of freedom: its threshold is the one that K of them together pass with probability
// .001 at most (Bonferroni), -2 ln(.001 / K). Neighbours are correlated, so the true rate is below that.
// Where the residuals are larger than the noise is said to be and a change does not mend that, it is the noise that is
// larger: statistics then count in units of what is left, as an F test's do.
#pragma once

#include <limits>
#include <optional>
#include <vector>

#include "truebearing/tma/batch_estimate.hpp"
#include "truebearing/tma/bearing_window.hpp"
#include "truebearing/tma/doppler_window.hpp"
#include "truebearing/tma/outliers.hpp"
#include "truebearing/tma/velocity_change.hpp"

namespace truebearing {

/// Sum of squared normalised residuals against its law.
struct SumOfSquares {
  double chi_square = 0.0;
  int degrees_of_freedom = 0;
  bool too_large = false;  ///< above its 99.9 % quantile
  bool too_small = false;  ///< below its .1 % quantile

  SumOfSquares() = default;
  SumOfSquares(double chi_square, int degrees_of_freedom);
  bool fits() const { return !too_large && !too_small; }
};

/// A constant error of all bearings, as the residuals show it.
struct BearingBias {
  double bias_rad = 0.0;
  double sigma_rad = std::numeric_limits<double>::infinity();  ///< infinite where the geometry hides it
  /// How far an error of one radian moves the least-squares estimate: [east, north, v_east, v_north] at its time.
  Eigen::Vector4d moves = Eigen::Vector4d::Zero();
  bool detected = false;
  // Where it is detected:
  double gain = 0.0;         ///< 2 ln of the likelihood ratio to no error
  BatchEstimate estimate{};  ///< the least squares without it, its uncertainty in P
};

struct ResidualChecks {
  double chi_square = 0.0;  ///< sum of squared normalised residuals, of the estimate and of all rows
  int degrees_of_freedom = 0;
  double lag_one = 0.0;      ///< autocorrelation at lag one times sqrt(m): N(0, 1) where they are white; NaN where they
                             ///< are nothing but rounding
  double manoeuvre = 0.0;    ///< largest statistic over the times that were looked at
  double manoeuvre_s = 0.0;  ///< the time it belongs to

  bool fits = true;         ///< chi_square between its .1 % and 99.9 % quantiles
  bool too_small = false;   ///< below the first
  bool white = true;        ///< |lag_one| below its 99.9 % quantile
  bool manoeuvred = false;  ///< the largest statistic would come by chance in less than one window of a thousand

  /// Without the bearings that are outliers, at the least squares of the rest.
  std::vector<Outlier> outliers;
  BatchEstimate least_squares;
  SumOfSquares rest;
  std::optional<VelocityChange> change;  ///< where the target manoeuvred
  BearingBias bias;
  /// What the standard deviations of bearings and of frequencies would have to be multiplied by for the residuals of
  /// the rest to be as they should; after the change where there is one. NaN where there are none.
  double bearing_sigmas = 1.0, frequency_sigmas = std::numeric_limits<double>::quiet_NaN();
};

/// `estimate` must have been made from `window`, of five bearings or more, and from `frequencies` where given.
ResidualChecks check_residuals(const BearingWindow& window, const BatchEstimate& estimate,
                               const DopplerWindow* frequencies = nullptr);

}  // namespace truebearing
