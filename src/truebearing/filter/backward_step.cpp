// SPDX-License-Identifier: Apache-2.0
#include "truebearing/filter/backward_step.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "truebearing/core/covariance.hpp"

namespace truebearing {
namespace {

void symmetrise(BoundedMatrix& P) {
  P = (0.5 * (P + P.transpose())).eval();
}

// Mode i's estimate in the space of a mode whose own stands beside it: what i lacks is that mode's.
ModeEstimate fitted(const ModeEstimate& i, const ModeEstimate& own) {
  if (i.x.size() == own.x.size()) return i;
  const Eigen::Index shared = std::min(i.x.size(), own.x.size());
  ModeEstimate fit = own;
  fit.x.head(shared) = i.x.head(shared);
  fit.P.leftCols(shared).setZero();
  fit.P.topRows(shared).setZero();
  fit.P.topLeftCorner(shared, shared) = i.P.topLeftCorner(shared, shared);
  return fit;
}

// Mode i's estimate given what was found of its beginning in another mode's space: what that lacks follows by
// regression.
ModeEstimate unfitted(const ModeEstimate& i, const ModeEstimate& found) {
  const Eigen::Index n = i.x.size(), shared = std::min(n, found.x.size());
  if (shared == n) return {found.x.head(n), found.P.topLeftCorner(n, n)};
  const BoundedMatrix own = i.P.topLeftCorner(shared, shared);
  const BoundedMatrix A = Eigen::LDLT<BoundedMatrix>(own).solve(i.P.topRows(shared)).transpose();  // (n x shared)
  ModeEstimate whole{i.x + A * (found.x - i.x.head(shared)), i.P + A * (found.P - own) * A.transpose()};
  symmetrise(whole.P);
  return whole;
}

ModeEstimate moments_of(const std::vector<ModeEstimate>& parts, const ModeVector& weights, Eigen::Index n) {
  ModeEstimate all{BoundedVector::Zero(n), BoundedMatrix::Zero(n, n)};
  for (std::size_t i = 0; i < parts.size(); ++i)
    all.x.head(parts[i].x.size()) += weights[static_cast<Eigen::Index>(i)] * parts[i].x;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const double weight = weights[static_cast<Eigen::Index>(i)];
    if (weight == 0.0) continue;
    const Eigen::Index length = parts[i].x.size();
    BoundedVector d = -all.x;
    d.head(length) += parts[i].x;
    all.P += weight * d * d.transpose();
    all.P.topLeftCorner(length, length) += weight * parts[i].P;
  }
  return all;
}

// x_s and P_s of Rauch, Tung and Striebel.
ModeEstimate looked_back(const ModeEstimate& filtered, const ModeEstimate& predicted, const BoundedMatrix& C,
                         const ModeEstimate& next) {
  const BoundedMatrix G = Eigen::LDLT<BoundedMatrix>(predicted.P).solve(C.transpose()).transpose();
  ModeEstimate smoothed{filtered.x + G * (next.x - predicted.x),
                        filtered.P + G * (next.P - predicted.P) * G.transpose()};
  symmetrise(smoothed.P);
  return smoothed;
}

// L_j in coordinates u = V' L^-1 (x - x_pred), P_pred = L L', in which the prediction is N(0, I) and the smoothed estimate
// N(a, diag m): exp(-u' E u / 2 + y' u), E = 1/m - 1, y = a / m. A direction in which the mixture came out wider than the
// prediction, m > 1, is one of which the future says nothing, and keeps what it is wider by.
class Future {
 public:
  Future(const ModeEstimate& predicted, const ModeEstimate& smoothed) : x_pred_(predicted.x), root_(predicted.P) {
    constexpr double kLeast = 1e-12;  // of m: a future that knows all
    valid_ = root_.info() == Eigen::Success;
    if (!valid_) return;
    const auto L = root_.matrixL();
    const BoundedMatrix half = L.solve(smoothed.P);
    const BoundedMatrix M = L.solve(half.transpose());
    const Eigen::SelfAdjointEigenSolver<BoundedMatrix> modes(M);
    V_ = modes.eigenvectors();
    const BoundedVector m = modes.eigenvalues().cwiseMax(kLeast);
    const BoundedVector known = m.cwiseMin(1.0);
    excess_ = m - known;
    T_ = (known.cwiseInverse().array() - 1.0).max(0.0).sqrt();
    y_ = (V_.transpose() * BoundedVector(L.solve(smoothed.x - x_pred_))).cwiseQuotient(known);
    valid_ = V_.allFinite() && y_.allFinite() && T_.allFinite();
  }

  bool valid() const { return valid_; }

  // N_ij of another prediction, and the logarithm of the integral.
  ModeEstimate weigh(const ModeEstimate& prediction, double& log_weight) const {
    const auto L = root_.matrixL();
    const BoundedVector b = V_.transpose() * BoundedVector(L.solve(prediction.x - x_pred_));
    const BoundedMatrix half = L.solve(prediction.P);
    const BoundedMatrix B = V_.transpose() * BoundedMatrix(L.solve(half.transpose())) * V_;
    const BoundedMatrix BT = B * T_.asDiagonal();
    const Eigen::Index n = b.size();
    const Eigen::LLT<BoundedMatrix> A(BoundedMatrix::Identity(n, n) + T_.asDiagonal() * BT);
    BoundedMatrix P = B - BT * A.solve(BT.transpose());
    const BoundedVector rest = y_ - T_.cwiseAbs2().cwiseProduct(b);
    const BoundedVector moved = P * rest;
    log_weight = -0.5 * b.dot(T_.cwiseAbs2().cwiseProduct(b)) + y_.dot(b) + 0.5 * rest.dot(moved) -
                 A.matrixLLT().diagonal().array().log().sum();
    P += excess_.asDiagonal();
    const BoundedMatrix LV = BoundedMatrix(L) * V_;
    return {x_pred_ + LV * (b + moved), LV * P * LV.transpose()};
  }

 private:
  BoundedVector x_pred_;
  Eigen::LLT<BoundedMatrix> root_;
  BoundedMatrix V_;
  BoundedVector T_, y_, excess_;  // T = E^1/2
  bool valid_ = false;
};

// mu_i|j (r) of the mixing into mode j.
ModeVector mixing_weights(const ModeMatrix& Pi, const ModeVector& mu, Eigen::Index j, double c) {
  return c > 0.0 ? ModeVector(Pi.col(j).cwiseProduct(mu) / c) : ModeVector(ModeVector::Unit(mu.size(), j));
}

std::vector<ModeEstimate> all_in_space_of(std::size_t j, const ModeEstimates& estimates) {
  std::vector<ModeEstimate> fit;
  for (const ModeEstimate& estimate : estimates.modes) fit.push_back(fitted(estimate, estimates.modes[j]));
  return fit;
}

bool is_estimate(const ModeEstimate& estimate) {
  return estimate.x.allFinite() && is_covariance(estimate.P);
}

// Each mode as its pairs with the modes that may follow it, of weights w (r x r), are together.
std::optional<ModeEstimates> pooled(const ModeEstimates& filtered, const std::vector<std::vector<ModeEstimate>>& pairs,
                                    const ModeMatrix& w) {
  ModeEstimates smoothed{{}, w.rowwise().sum() / w.sum()};
  if (!smoothed.mu.allFinite()) return std::nullopt;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const ModeVector weights = w.row(static_cast<Eigen::Index>(i)).transpose();
    const double total = weights.sum();
    const ModeEstimate& own = filtered.modes[i];
    smoothed.modes.push_back(total > 0.0 ? moments_of(pairs[i], weights / total, own.x.size()) : own);
    if (!is_estimate(smoothed.modes.back())) return std::nullopt;
  }
  return smoothed;
}

}  // namespace

ModeEstimates estimates_of(const TrackedState& state) {
  ModeEstimates estimates;
  if (state.modes().empty()) return {{{state.x(), state.P()}}, ModeVector::Ones(1)};
  for (const auto& mode : state.modes()) estimates.modes.push_back({mode->x(), mode->P()});
  estimates.mu = *state.mode_probabilities();
  return estimates;
}

ModeEstimate mixture_of(const ModeEstimates& estimates) {
  if (estimates.modes.size() == 1) return estimates.modes.front();
  Eigen::Index n = 0;
  for (const ModeEstimate& mode : estimates.modes) n = std::max(n, mode.x.size());
  return moments_of(estimates.modes, estimates.mu, n);
}

BackwardStep::BackwardStep(const TrackedState& state) : chain_(state.fresh()) {
  if (state.modes().empty()) scratch_.push_back(state.fresh());
  for (const auto& mode : state.modes()) scratch_.push_back(mode->fresh());
}

std::optional<BackwardStep::Crossing> BackwardStep::cross(std::size_t mode, const ModeEstimate& estimate, double dt_s) {
  TrackedState& state = *scratch_[mode];
  state.begin(estimate.x.data(), estimate.P.data());
  Crossing crossing;
  crossing.C = state.cross_covariance(dt_s);
  if (state.predict(dt_s) == StepStatus::failed) return std::nullopt;
  crossing.predicted = {state.x(), state.P()};
  return crossing;
}

std::optional<ModeEstimates> BackwardStep::predicted(const ModeEstimates& filtered, double dt_s) {
  if (!(dt_s > 0.0)) return filtered;
  const ModeMatrix Pi = chain_->transition(dt_s);
  ModeEstimates predicted{{}, Pi.transpose() * filtered.mu};
  for (std::size_t j = 0; j < modes(); ++j) {
    const auto place = static_cast<Eigen::Index>(j);
    const ModeEstimate mixed = modes() == 1 ? filtered.modes[0]
                                            : moments_of(all_in_space_of(j, filtered),
                                                         mixing_weights(Pi, filtered.mu, place, predicted.mu[place]),
                                                         filtered.modes[j].x.size());
    const std::optional<Crossing> crossing = cross(j, mixed, dt_s);
    if (!crossing) return std::nullopt;
    predicted.modes.push_back(crossing->predicted);
  }
  return predicted;
}

std::optional<ModeEstimates> BackwardStep::smoothed(const ModeEstimates& filtered, double dt_s,
                                                    const ModeEstimates& next, double widened) {
  if (!(dt_s > 0.0)) return next;
  if (modes() > 1) return smoothed_together(filtered, dt_s, next);
  std::optional<Crossing> crossing = cross(0, filtered.modes[0], dt_s);
  if (!crossing) return std::nullopt;
  crossing->predicted.P *= widened;
  ModeEstimates smoothed{{looked_back(filtered.modes[0], crossing->predicted, crossing->C, next.modes[0])}, next.mu};
  return is_estimate(smoothed.modes[0]) ? std::optional(smoothed) : std::nullopt;
}

std::optional<ModeEstimates> BackwardStep::smoothed_together(const ModeEstimates& filtered, double dt_s,
                                                             const ModeEstimates& next) {
  const ModeMatrix Pi = chain_->transition(dt_s);
  const std::optional<ModeEstimates> predictions = predicted(filtered, dt_s);
  if (!predictions) return std::nullopt;
  const auto r = static_cast<Eigen::Index>(modes());
  ModeMatrix w = ModeMatrix::Zero(r, r);
  std::vector<std::vector<ModeEstimate>> pairs(modes());  // [i][j]
  for (std::size_t i = 0; i < modes(); ++i) pairs[i].assign(modes(), filtered.modes[i]);
  for (std::size_t j = 0; j < modes(); ++j) {
    const auto col = static_cast<Eigen::Index>(j);
    const double c = predictions->mu[col];
    if (!(next.mu[col] > 0.0) || !(c > 0.0)) continue;
    const ModeVector before = mixing_weights(Pi, filtered.mu, col, c);
    const Future future(predictions->modes[j], next.modes[j]);
    ModeVector log_weight = before.array().log();
    for (std::size_t i = 0; i < modes(); ++i) {
      const auto row = static_cast<Eigen::Index>(i);
      if (!(before[row] > 0.0)) continue;
      const ModeEstimate fit = fitted(filtered.modes[i], filtered.modes[j]);
      const std::optional<Crossing> crossing = cross(j, fit, dt_s);
      if (!crossing) return std::nullopt;
      double gained = 0.0;
      const ModeEstimate to = future.valid() ? future.weigh(crossing->predicted, gained) : next.modes[j];
      log_weight[row] += gained;
      pairs[i][j] = unfitted(filtered.modes[i], looked_back(fit, crossing->predicted, crossing->C, to));
    }
    const ModeVector weights = (log_weight.array() - log_weight.maxCoeff()).exp();
    w.col(col) = next.mu[col] * weights / weights.sum();
  }
  return pooled(filtered, pairs, w);
}

}  // namespace truebearing
