#include "truebearing/tma/residual_checks.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "truebearing/core/chi_square.hpp"
#include "truebearing/core/linear_algebra.hpp"

namespace truebearing {
namespace {

constexpr double kConfidence = 0.999;
constexpr int kParameters = 4;

// g' S^-1 g without the directions in which S is nothing but rounding: there a change would look like no change.
double score(const Eigen::Vector2d& g, const Eigen::Matrix2d& S, double whole) {
  const SymmetricModes<2> modes = symmetric_modes(S);
  double sum = 0.0;
  for (int i = 0; i < 2; ++i) {
    const double projected = modes.vectors.col(i).dot(g);
    if (modes.values[i] > 1e-9 * whole) sum += projected * projected / modes.values[i];
  }
  return sum;
}

// What the residuals r of one kind of measurement say of a change in velocity at change_s: sums of w G r, w G G' and
// w G J', with G the change's row.
struct ChangeSums {
  Eigen::Vector2d g = Eigen::Vector2d::Zero();
  Eigen::Matrix2d GG = Eigen::Matrix2d::Zero();
  Eigen::Matrix<double, 2, 4> GJ = Eigen::Matrix<double, 2, 4>::Zero();

  void add(double w, double r, const Eigen::Vector2d& G, const Eigen::RowVector4d& J) {
    g += w * r * G;
    GG += w * G * G.transpose();
    GJ += w * G * J;
  }
};

// Frequencies at an estimate: what is left of them, and their rows of J.
class FrequencyRows {
 public:
  FrequencyRows(const DopplerWindow& window, const BatchEstimate& estimate) : window_(window) {
    window.sources(estimate.x, estimate.time_s, sources_);
    for (std::size_t i = 0; i < window.size(); ++i) {
      const DopplerWindow::Shift shift = window.shift(i, estimate.x, estimate.time_s);
      const double f0 = sources_[level(i)].frequency_hz;
      rows_.push_back({window.time_s(i), window.time_s(i) - estimate.time_s, window.weight(i), shift.value,
                       window.frequency_hz(i) - f0 * shift.value, f0 * shift.per_state});
    }
  }

  double normalised(std::size_t i) const { return rows_[i].residual_hz * std::sqrt(rows_[i].weight); }

  Eigen::Matrix4d information() const {
    Eigen::Matrix4d A = Eigen::Matrix4d::Zero();
    std::vector<Eigen::RowVector4d> of_levels(sources_.size(), Eigen::RowVector4d::Zero());
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      A += rows_[i].weight * rows_[i].J.transpose() * rows_[i].J;
      of_levels[level(i)] += rows_[i].weight * rows_[i].shift * rows_[i].J;
    }
    for (std::size_t l = 0; l < of_levels.size(); ++l)
      A -= sources_[l].variance * of_levels[l].transpose() * of_levels[l];
    return A;
  }

  /// Adds their sums, less what the f0s can take of them.
  void add(double change_s, ChangeSums& sums) const {
    std::vector<Eigen::Vector2d> taken(sources_.size(), Eigen::Vector2d::Zero());
    std::vector<Eigen::RowVector4d> of_levels(sources_.size(), Eigen::RowVector4d::Zero());
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      const Row& row = rows_[i];
      of_levels[level(i)] += row.weight * row.shift * row.J;
      if (row.time_s <= change_s) continue;
      // Of the velocity alone, and of the way that it makes since then.
      const Eigen::Vector2d place = row.J.head<2>().transpose(), velocity = row.J.tail<2>().transpose() - row.t * place;
      const Eigen::Vector2d G = (row.time_s - change_s) * place + velocity;
      sums.add(row.weight, row.residual_hz, G, row.J);
      taken[level(i)] += row.weight * row.shift * G;
    }
    for (std::size_t l = 0; l < sources_.size(); ++l) {
      sums.GG -= sources_[l].variance * taken[l] * taken[l].transpose();
      sums.GJ -= sources_[l].variance * taken[l] * of_levels[l];
    }
  }

 private:
  struct Row {
    double time_s, t, weight, shift, residual_hz;
    Eigen::RowVector4d J;
  };
  std::size_t level(std::size_t i) const { return static_cast<std::size_t>(window_.level(i)); }

  const DopplerWindow& window_;
  std::vector<SourceFrequency> sources_;
  std::vector<Row> rows_;
};

}  // namespace

ResidualChecks check_residuals(const BearingWindow& window, const BatchEstimate& estimate,
                               const DopplerWindow* frequencies) {
  constexpr std::size_t kTimes = 40, kMargin = 3;
  const std::size_t m = window.size(), n = frequencies ? frequencies->size() : 0;
  const double origin_s = estimate.time_s;
  std::optional<FrequencyRows> rows;
  if (frequencies) rows.emplace(*frequencies, estimate);
  ResidualChecks checks;
  checks.degrees_of_freedom = static_cast<int>(m + n) - kParameters - (frequencies ? frequencies->levels() : 0);

  double products = 0.0;
  const auto sum_up = [&](std::size_t count, const auto& normalised) {
    double previous = 0.0;
    for (std::size_t i = 0; i < count; ++i) {
      const double e = normalised(i);
      checks.chi_square += e * e;
      products += e * previous;
      previous = e;
    }
  };
  sum_up(m, [&](std::size_t i) { return window.residual(i, estimate.x, origin_s) * std::sqrt(window.weight(i)); });
  sum_up(n, [&](std::size_t i) { return rows->normalised(i); });
  checks.lag_one = products / checks.chi_square * std::sqrt(static_cast<double>(m + n));
  checks.fits = checks.chi_square <= chi_square_quantile(kConfidence, checks.degrees_of_freedom);
  checks.white = std::abs(checks.lag_one) <= normal_quantile(0.5 + 0.5 * kConfidence);

  Eigen::Matrix4d information = window.cartesian(estimate.x, origin_s).A;
  if (rows) information += rows->information();
  const Eigen::Matrix4d P = covariance_of(information);
  const std::size_t step = std::max<std::size_t>(1, m / kTimes);
  int looked_at = 0;
  for (std::size_t change = kMargin; change + kMargin < m; change += step, ++looked_at) {
    ChangeSums sums;
    for (std::size_t i = change + 1; i < m; ++i) {
      const Eigen::RowVector4d J = window.jacobian(i, estimate.x, origin_s);
      const Eigen::Vector2d G = (window.time_s(i) - window.time_s(change)) * J.head<2>().transpose();
      sums.add(window.weight(i), window.residual(i, estimate.x, origin_s), G, J);
    }
    if (rows) rows->add(window.time_s(change), sums);
    const double statistic = score(sums.g, sums.GG - sums.GJ * P * sums.GJ.transpose(), sums.GG.trace());
    if (statistic <= checks.manoeuvre) continue;
    checks.manoeuvre = statistic;
    checks.manoeuvre_s = window.time_s(change);
  }
  if (looked_at > 0) checks.manoeuvred = checks.manoeuvre > -2.0 * std::log((1.0 - kConfidence) / looked_at);
  return checks;
}

}  // namespace truebearing
