// SPDX-License-Identifier: Apache-2.0
#include "truebearing/tma/outlier_deletion.hpp"

#include <algorithm>
#include <cmath>

#include "truebearing/core/chi_square.hpp"
#include "truebearing/tma/velocity_change.hpp"

namespace truebearing {
namespace {

constexpr double kFalselyDeleted = 1e-3;
constexpr int kOfMotion = 4, kOfChange = 2;  // parameters
constexpr double kLeastChange = 1e-6;        // of 1 - h, and of an objective
constexpr std::size_t kFewForPairs = 100;    // bearings: where two may have the leverage to hide each other

// Of one in twenty bearings, as many as this in a log come once in hundreds of logs; more are another contact or another
// noise. One degree of freedom stays.
std::size_t most_outliers(std::size_t bearings) {
  return std::min(std::max<std::size_t>(bearings / 5, 2), bearings - kOfMotion - 1);
}

void toggle(std::size_t i, std::vector<std::size_t>& left_out) {
  const auto place = std::lower_bound(left_out.begin(), left_out.end(), i);
  if (place != left_out.end() && *place == i)
    left_out.erase(place);
  else
    left_out.insert(place, i);
}

}  // namespace

OutlierDeletion::OutlierDeletion(const BearingWindow& bearings, const DopplerWindow* frequencies)
    : bearings_(bearings),
      frequencies_(frequencies),
      rows_(bearings, frequencies),
      limit_(normal_quantile(1.0 - 0.5 * kFalselyDeleted / static_cast<double>(bearings.size()))),
      price_(limit_ * limit_),
      most_(most_outliers(bearings.size())) {}

std::vector<bool> OutlierDeletion::kept_without(std::span<const std::size_t> left_out) const {
  std::vector<bool> kept(bearings_.size(), true);
  for (const std::size_t i : left_out) kept[i] = false;
  return kept;
}

bool OutlierDeletion::fits(double sum_of_squares, std::size_t left_out, int parameters) const {
  int freedom = static_cast<int>(bearings_.size()) - static_cast<int>(left_out) - parameters;
  if (frequencies_) freedom += static_cast<int>(frequencies_->size()) - frequencies_->levels();
  return sum_of_squares <= chi_square_quantile(1.0 - kFalselyDeleted, std::max(freedom, 1));
}

double OutlierDeletion::growth(const Spread& spread, std::size_t i, double s1, std::size_t j, double s2) {
  const auto k = static_cast<Eigen::Index>(i), l = static_cast<Eigen::Index>(j);
  const double e1 = spread.e[k], e2 = spread.e[l], h = spread.h(k, l);
  const double a = s1 + spread.h(k, k), b = s2 + spread.h(l, l), determinant = a * b - h * h;
  // Of the sign of s1 s2, but where leverages are one.
  if (!(s1 * s2 * determinant > kLeastChange)) return std::numeric_limits<double>::infinity();
  return (b * e1 * e1 - 2.0 * h * e1 * e2 + a * e2 * e2) / determinant;
}

template <int N, typename Of>
OutlierDeletion::Spread OutlierDeletion::spread(const Of& of_row, std::span<const std::size_t> left_out) const {
  const std::span<const MotionRow> rows = rows_.bearings();
  Eigen::Matrix<double, N, N> information = rows_.equations<N>(of_row).A;
  for (const std::size_t i : left_out) {
    const Eigen::Matrix<double, 1, N> j = of_row(rows[i]);
    information -= j.transpose() * j;
  }
  const Eigen::Matrix<double, N, N> root = root_of_inverse<N>(information);
  Spread spread{Eigen::VectorXd(bearings_.size()), Eigen::MatrixXd(bearings_.size(), N)};
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    spread.e[k] = rows[i].residual;
    spread.rows.row(k) = of_row(rows[i]) * root;
  }
  return spread;
}

std::vector<OutlierDeletion::Step> OutlierDeletion::singles(const Spread& spread,
                                                            std::span<const std::size_t> left_out) const {
  const std::vector<bool> kept = kept_without(left_out);
  std::vector<Step> steps;
  for (std::size_t i = 0; i < bearings_.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    const double s = kept[i] ? -1.0 : 1.0, h = spread.h(k, k);
    if ((kept[i] && left_out.size() >= most_) || !(s * (s + h) > kLeastChange)) continue;
    const double change = spread.e[k] * spread.e[k] / (s + h) - s * price_;
    if (change < -kLeastChange) steps.push_back({change, {i}});
  }
  return steps;
}

std::vector<OutlierDeletion::Step> OutlierDeletion::pairs(const Spread& spread,
                                                          std::span<const std::size_t> left_out) const {
  const std::vector<bool> kept = kept_without(left_out);
  std::vector<Step> steps;
  for (std::size_t i = 0; i < bearings_.size(); ++i)
    for (std::size_t j = i + 1; j < bearings_.size(); ++j) {
      const double s1 = kept[i] ? -1.0 : 1.0, s2 = kept[j] ? -1.0 : 1.0;
      if (static_cast<double>(left_out.size()) - s1 - s2 > static_cast<double>(most_)) continue;
      const double change = growth(spread, i, s1, j, s2) - (s1 + s2) * price_;
      if (change < -kLeastChange) steps.push_back({change, {i, j}});
    }
  return steps;
}

bool OutlierDeletion::improve(const Spread& spread, std::vector<std::size_t>& left_out) const {
  std::vector<Step> steps = singles(spread, left_out);
  if (steps.empty() && bearings_.size() <= kFewForPairs) steps = pairs(spread, left_out);
  if (steps.empty()) return false;
  const auto promises_more = [](const Step& a, const Step& b) { return a.change < b.change; };
  for (const std::size_t i : std::min_element(steps.begin(), steps.end(), promises_more)->places) toggle(i, left_out);
  return true;
}

std::vector<Outlier> OutlierDeletion::outliers(const Spread& spread, std::span<const std::size_t> left_out) const {
  const double told_apart = chi_square_quantile(0.99, 1.0);
  const std::vector<bool> kept = kept_without(left_out);
  std::vector<Outlier> outliers;
  for (const std::size_t i : left_out) {
    const auto k = static_cast<Eigen::Index>(i);
    outliers.push_back({i, spread.e[k] / std::sqrt(1.0 + spread.h(k, k))});
    double least = told_apart;
    for (std::size_t j = 0; j < bearings_.size(); ++j) {
      if (!kept[j]) continue;
      const double change = growth(spread, i, 1.0, j, -1.0);
      if (change < least) least = change, outliers.back().or_else = j;
    }
  }
  return outliers;
}

BatchEstimate OutlierDeletion::fit(const BearingWindow& rest, const BatchEstimate& start) {
  Eigen::Vector4d warm = start.x;
  warm.head<2>() += (rest.last_time_s() - start.time_s) * warm.tail<2>();
  return batch_.solve(rest, std::nullopt, &warm, frequencies_);
}

OutlierDeletion::Explanation OutlierDeletion::steady(std::vector<std::size_t> left_out, const BatchEstimate& start) {
  const auto of_row = [](const MotionRow& row) { return row.of_y; };
  Explanation best;
  BatchEstimate estimate = start;
  while (left_out.size() <= most_) {
    estimate = fit(bearings_.without(left_out), estimate);
    const double squares = 2.0 * estimate.cost, objective = squares + price_ * static_cast<double>(left_out.size());
    if (!estimate.found || !(objective < best.objective - kLeastChange)) break;
    rows_.look_at(polar_of(estimate, rows_.polar()));
    const Spread spread = this->spread<kOfMotion>(of_row, left_out);
    if (!spread.rows.allFinite() || !spread.e.allFinite()) break;
    best = {left_out, estimate, objective, fits(squares, left_out.size(), kOfMotion), outliers(spread, left_out)};
    if (!improve(spread, left_out)) break;
  }
  return best;
}

OutlierDeletion::Explanation OutlierDeletion::changed(std::vector<std::size_t> left_out, const BatchEstimate& start) {
  constexpr int kMostRounds = 3;  // each looks for the time of the change anew
  Explanation best;
  BatchEstimate estimate = start;
  for (int round = 0; round < kMostRounds && left_out.size() <= most_; ++round) {
    const BearingWindow rest = bearings_.without(left_out);
    estimate = fit(rest, estimate);
    if (!estimate.found) break;
    VelocityChangeScan scan(rest, frequencies_, estimate);
    if (scan.times() == 0) break;
    const VelocityChange change = scan.fit();
    const double squares = 2.0 * change.cost,
                 objective = squares + price_ * static_cast<double>(left_out.size()) + scan.threshold(kFalselyDeleted);
    if (!(objective < best.objective - kLeastChange)) break;
    const auto of_row = [&](const MotionRow& row) {
      Eigen::Matrix<double, 1, kOfMotion + kOfChange> j;
      j << row.of_y, row.of_change(change.time_s);
      return j;
    };
    rows_.look_at(polar_of(change.before(estimate.time_s), rows_.polar()), change.change_mps, change.time_s);
    const Spread spread = this->spread<kOfMotion + kOfChange>(of_row, left_out);
    if (!spread.rows.allFinite() || !spread.e.allFinite()) break;
    best = {left_out, estimate, objective, fits(squares, left_out.size(), kOfMotion + kOfChange),
            outliers(spread, left_out)};
    const std::vector<Step> steps = singles(spread, left_out);
    if (steps.empty()) break;
    for (const Step& step : steps) toggle(step.places.front(), left_out);
  }
  return best;
}

std::vector<std::size_t> OutlierDeletion::farther_than_limit(const BatchEstimate& estimate) const {
  std::vector<std::size_t> places;
  for (std::size_t i = 0; i < bearings_.size(); ++i) {
    const double e = bearings_.residual(i, estimate.x, estimate.time_s) * std::sqrt(bearings_.weight(i));
    if (std::abs(e) > limit_) places.push_back(i);
  }
  return places;
}

OutlierDeletion::Explanation OutlierDeletion::best_steady(const BatchEstimate& estimate,
                                                          const std::vector<std::size_t>& off_neighbours) {
  Explanation best;
  const auto consider = [&](const std::vector<std::size_t>& left_out, const BatchEstimate& start) {
    Explanation explanation = steady(left_out, start);
    if (explanation.objective < best.objective) best = std::move(explanation);
  };
  if (off_neighbours.empty() || bearings_.size() <= kFewForPairs) consider({}, estimate);
  if (best.left_out.empty() && best.fits) return best;
  if (!off_neighbours.empty()) consider(off_neighbours, estimate);
  // Huber's loss is pulled less.
  TargetMotionBatch robust({.huber_sigmas = 1.345});  // 95 % efficient where nothing is wrong (Huber 1981)
  const BatchEstimate pulled_less = robust.solve(bearings_, std::nullopt, &estimate.x, frequencies_);
  if (pulled_less.found) consider(farther_than_limit(pulled_less), pulled_less);
  return best;
}

// Outliers pull at the estimate by which they are known, so both in turn until they agree.
std::vector<Outlier> OutlierDeletion::off_their_neighbours(const BatchEstimate& estimate) {
  constexpr int kMostRounds = 6;
  std::vector<Outlier> outliers;
  BatchEstimate about = estimate;
  for (int round = 0; round < kMostRounds; ++round) {
    const BatchEstimate better = fit(bearings_.without(places(outliers)), about);
    if (better.found) about = better;
    const std::span<const Outlier> found = find_off_neighbours_(bearings_, about);
    const bool known = places(found) == places(outliers);
    outliers.assign(found.begin(), found.end());
    if (known) break;
  }
  return outliers;
}

std::vector<Outlier> OutlierDeletion::find(const BatchEstimate& estimate) {
  const double against_steady = -2.0 * std::log(kFalselyDeleted);
  const std::vector<Outlier> off = off_their_neighbours(estimate);
  const std::vector<std::size_t> isolated = places(off);
  Explanation best = best_steady(estimate, isolated);
  // What does not belong to its neighbours is an outlier, whichever way the target went.
  const bool whichever = std::includes(isolated.begin(), isolated.end(), best.left_out.begin(), best.left_out.end());
  if (best.fits && (whichever || best.left_out.size() == 1)) return best.outliers;
  // A steady target is what a change has to disprove.
  Explanation other = changed(isolated, estimate);
  if (other.fits && (!best.fits || other.objective + against_steady < best.objective)) best = std::move(other);
  return best.fits ? best.outliers : off;
}

}  // namespace truebearing
