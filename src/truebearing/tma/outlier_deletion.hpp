// SPDX-License-Identifier: Apache-2.0
// Outliers among bearings by deletion: those without which one course and speed, or a single change of velocity,
// explains the rest. With e the normalised residuals about the fit to the bearings that are kept, J their rows by the
// motion, P the inverse information of that fit and h = j P j' the leverage of a bearing, its deleted residual (Belsley,
// Kuh and Welsch 1980, 2.1, of known standard deviations)
//
//     d^2 = e^2 / (1 - h) of one that is kept,  d^2 = e^2 / (1 + h) of one that is left out
//
// is what the sum of squares would lose, or gain, and chi-square with one degree of freedom where the bearing is good.
// An outlier of D sigma has d about D sqrt(1 - h): one of leverage near 1 does not show. For several at once (T, with
// s = 1 for each that comes back and -1 for each that goes) it gains
//
//     e_T' (diag(s) + J_T P J_T')^-1 e_T
//
// Left out are those that make the sum of squares of the rest and q for each outlier smallest. q is the d^2 that the
// largest of all m good bearings passes with probability .001 at most (Bonferroni). One at a time, or two where outliers
// hide each other, with a fit after each.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "truebearing/tma/batch_estimate.hpp"
#include "truebearing/tma/bearing_window.hpp"
#include "truebearing/tma/doppler_window.hpp"
#include "truebearing/tma/motion_rows.hpp"
#include "truebearing/tma/outliers.hpp"
#include "truebearing/tma/target_motion_batch.hpp"

namespace truebearing {

class OutlierDeletion {
 public:
  /// The windows, of five bearings or more, must outlive this. `frequencies` may be nullptr.
  OutlierDeletion(const BearingWindow& bearings, const DopplerWindow* frequencies);

  /// In order of time. `estimate`: of one course and speed, where the search begins. Where neither model explains the
  /// rest as well as it should (chi-square below its 99.9 % quantile), those that do not belong to their neighbours.
  std::vector<Outlier> find(const BatchEstimate& estimate);

  /// d of an outlier for it to be called one.
  double limit() const { return limit_; }

 private:
  /// What is left out, and how well a model explains the rest.
  struct Explanation {
    std::vector<std::size_t> left_out;
    BatchEstimate estimate{};  // of one course and speed
    double objective = std::numeric_limits<double>::infinity();
    bool fits = false;
    std::vector<Outlier> outliers{};
  };
  /// Residuals of all bearings and their rows times the root of P: leverages are products of these.
  struct Spread {
    Eigen::VectorXd e;
    Eigen::MatrixXd rows;
    double h(Eigen::Index i, Eigen::Index k) const { return rows.row(i).dot(rows.row(k)); }
  };

  /// Bearings that change sides, and what the objective gains by it.
  struct Step {
    double change;
    std::vector<std::size_t> places;
  };

  std::vector<Outlier> off_their_neighbours(const BatchEstimate& estimate);
  Explanation steady(std::vector<std::size_t> left_out, const BatchEstimate& start);
  Explanation changed(std::vector<std::size_t> left_out, const BatchEstimate& start);
  /// By whichever of some sets to begin with is the best.
  Explanation best_steady(const BatchEstimate& estimate, const std::vector<std::size_t>& off_neighbours);
  std::vector<std::size_t> farther_than_limit(const BatchEstimate& estimate) const;
  BatchEstimate fit(const BearingWindow& rest, const BatchEstimate& start);

  template <int N, typename Of>
  Spread spread(const Of& of_row, std::span<const std::size_t> left_out) const;
  /// By how much the sum of squares grows where i and j change sides; s = -1 for one that goes.
  static double growth(const Spread& spread, std::size_t i, double s1, std::size_t j, double s2);
  /// Those that promise a smaller objective.
  std::vector<Step> singles(const Spread& spread, std::span<const std::size_t> left_out) const;
  std::vector<Step> pairs(const Spread& spread, std::span<const std::size_t> left_out) const;
  /// Takes the step that promises most; false where none promises anything.
  bool improve(const Spread& spread, std::vector<std::size_t>& left_out) const;
  std::vector<Outlier> outliers(const Spread& spread, std::span<const std::size_t> left_out) const;
  std::vector<bool> kept_without(std::span<const std::size_t> left_out) const;
  bool fits(double sum_of_squares, std::size_t left_out, int parameters) const;

  const BearingWindow& bearings_;
  const DopplerWindow* frequencies_;
  MotionRows rows_;
  TargetMotionBatch batch_;
  OutlierSearch find_off_neighbours_;
  double limit_, price_;  // of d, and its square
  std::size_t most_;      // outliers
};

}  // namespace truebearing
