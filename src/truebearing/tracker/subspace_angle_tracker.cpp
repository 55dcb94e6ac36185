// SPDX-License-Identifier: Apache-2.0
#include "truebearing/tracker/subspace_angle_tracker.hpp"

#include <algorithm>
#include <cmath>

#include "truebearing/array/direction_finding.hpp"
#include "truebearing/measurement/lagged_angle.hpp"
#include "truebearing/tracker/snapshot_guard.hpp"
#include "truebearing/tracker/start.hpp"

namespace truebearing {
namespace {

constexpr double kLargestAngle_rad = 1.55;  // short of end-fire
constexpr double kLeastCurvature = 1e-9;    // of |b|^2: less is rounding

}  // namespace

SubspaceAngleTracker::SubspaceAngleTracker(SubspaceAngleOptions options) : options_(options), past_(options.beta) {
  reset();
}

void SubspaceAngleTracker::reset() {
  guard_ = {};
  forget();
  first_track_ = 0;
}

// All targets, so that two intervals begin them anew.
void SubspaceAngleTracker::forget() {
  first_track_ += static_cast<int>(filters_.size());
  first_.reset();
  filters_.clear();
  predicted_.clear();
  records_.clear();
}

std::span<const StepRecord> SubspaceAngleTracker::step(const Measurement& measurement) {
  const StreamGuard::Verdict verdict = examine_snapshots(guard_, measurement, interval_);
  if (verdict == StreamGuard::Verdict::repeated || verdict == StreamGuard::Verdict::out_of_order) {
    refuse(records_);
    return records_;
  }
  bool usable = verdict == StreamGuard::Verdict::usable;
  if (usable && is_lost(measurement.time_s - used_time_s_)) forget();
  if (filters_.empty()) {
    if (!usable || !begin(measurement.time_s)) return {};
    used_time_s_ = measurement.time_s;
    known_ = filters_;
    return publish(measurement, 0.0, false);
  }
  if (usable && interval_.sensors() != orthogonal_.basis().rows()) {  // another array than the subspace is of
    ++guard_.counts.failed;
    usable = false;
  }
  if (usable) follow_subspace();
  return publish(measurement, measurement.time_s - used_time_s_, usable);
}

// Whether, dt_s after the last interval that was used, a target is outside the array's sector or anywhere in it.
bool SubspaceAngleTracker::is_lost(double dt_s) const {
  return std::any_of(filters_.begin(), filters_.end(), [&](Filter filter) {
    filter.predict(motion(), dt_s);
    return !is_in_sector(filter.x(), filter.P());
  });
}

SubspaceAngleTracker::Motion SubspaceAngleTracker::motion() const {
  return {{options_.q_rad2ps3}};
}

// Step 1: angles at two times, in the order of the angles.
bool SubspaceAngleTracker::begin(double time_s) {
  sample_covariance(interval_, covariance_);
  const int M = interval_.sensors();
  const SignalSubspace whole = signal_subspace(covariance_, M);
  int N = 0;
  if (first_)
    N = static_cast<int>(first_->angles.size());
  else if (const int* given = std::get_if<int>(&options_.targets))
    N = *given;
  else
    N = source_count(whole.eigenvalues, interval_.snapshots(), std::get<OrderCriterion>(options_.targets));
  if (N >= M) return false;  // more than the array could ever tell apart
  N = std::min(N, interval_.live_sensors() - 1);
  if (N < 1) return false;
  const Eigen::MatrixXcd E = whole.basis.leftCols(N);
  Start now{time_s, signal_angles({M, interval_.spacing_wavelengths()}, E)};
  if (!std::all_of(now.angles.begin(), now.angles.end(), [](double angle) { return std::isfinite(angle); }))
    return false;  // of an interval beyond all numbers
  if (!first_ || static_cast<int>(first_->angles.size()) != N || time_s <= first_->time_s) {
    first_ = std::move(now);
    return false;
  }
  const auto fix = [&](const Start& at, int n) -> PositionFix {
    return {BoundedVector::Constant(1, at.angles[static_cast<std::size_t>(n)]),
            BoundedMatrix::Constant(1, 1, options_.sigma_rad * options_.sigma_rad)};
  };
  for (int n = 0; n < N; ++n) {  // equation (21), with the rate's variance of two-point differencing
    const PriorStart start = two_point_state(fix(*first_, n), fix(now, n), time_s - first_->time_s);
    filters_.emplace_back(start.x, start.P);
  }
  predicted_ = filters_;
  past_.begin(E);
  orthogonal_.begin(E);
  eigenvectors_ = orthogonal_.basis();
  records_.assign(static_cast<std::size_t>(N), StepRecord{});
  return true;
}

const SplitMatrix<double>& SubspaceAngleTracker::basis() const {
  switch (options_.subspace) {
    case SubspaceAngleOptions::Subspace::orthogonal_iteration:
      return orthogonal_.basis();
    case SubspaceAngleOptions::Subspace::eigenvectors:
      return eigenvectors_;
    case SubspaceAngleOptions::Subspace::projection_approximation:
      break;
  }
  return past_.basis();
}

void SubspaceAngleTracker::follow_subspace() {
  const int N = static_cast<int>(filters_.size()), M = interval_.sensors();
  if (!basis().re.allFinite() || !basis().im.allFinite()) {  // the last interval was beyond all numbers: begin again
    sample_covariance(interval_, covariance_);
    const Eigen::MatrixXcd E = signal_subspace(covariance_, N).basis;
    past_.begin(E);
    orthogonal_.begin(E);
  }
  switch (options_.subspace) {
    case SubspaceAngleOptions::Subspace::projection_approximation:
      past_.update(interval_);
      break;
    case SubspaceAngleOptions::Subspace::orthogonal_iteration:
      orthogonal_.update(interval_);
      break;
    case SubspaceAngleOptions::Subspace::eigenvectors: {
      sample_covariance(interval_, covariance_);
      const Eigen::MatrixXcd E = signal_subspace(covariance_, N).basis;
      eigenvectors_.re = E.real();
      eigenvectors_.im = E.imag();
      break;
    }
  }
  if (!options_.sigma_from_subspace) return;
  // Rayleigh quotients of the basis, and the mean of what they leave.
  const SplitMatrix<double>& W = basis();
  double total = 0.0, signals = 0.0;
  const double Ns = interval_.snapshots();
  for (int t = 0; t < interval_.snapshots(); ++t)
    for (int m = 0; m < M; ++m) total += std::norm(interval_.value(t, m)) / Ns;
  for (Eigen::Index n = 0; n < N; ++n) {
    double power = 0.0;
    for (int t = 0; t < interval_.snapshots(); ++t) {
      std::complex<double> product = 0.0;
      for (int m = 0; m < M; ++m) product += std::complex<double>(W.re(m, n), -W.im(m, n)) * interval_.value(t, m);
      power += std::norm(product) / Ns;
    }
    signals += power / (W.re.col(n).squaredNorm() + W.im.col(n).squaredNorm());
  }
  noise_power_ = std::max((total - signals) / std::max(interval_.live_sensors() - N, 1), 1e-12 * total);
  signal_power_ = std::max(signals / N - noise_power_, 0.05 * noise_power_);
}

// Step 3 for every target, equation (13).
void SubspaceAngleTracker::find_innovations(const LineArray& array, double lag_s) {
  const std::size_t N = predicted_.size();
  expected_rad_.resize(N);
  found_.resize(N);
  const LaggedAngle model{lag_s, 1.0};
  for (std::size_t n = 0; n < N; ++n)
    expected_rad_[n] = std::clamp(model.h(predicted_[n].x())[0], -kLargestAngle_rad, kLargestAngle_rad);
  if (options_.innovation == SubspaceAngleOptions::Innovation::implicit) {
    implicit_.find(array, interval_.live(), expected_rad_, basis());
    for (std::size_t n = 0; n < N; ++n) found_[n] = {implicit_[n], implicit_.derivative_norm2(n)};
    return;
  }
  const Eigen::Index columns = static_cast<Eigen::Index>(N);
  if (a_.rows() != basis().rows() || a_.cols() != columns) {
    a_.setZero(basis().rows(), columns);
    b_.setZero(basis().rows(), columns);
  }
  for (Eigen::Index n = 0; n < columns; ++n) array.steer(expected_rad_[static_cast<std::size_t>(n)], n, a_, b_);
  for (int m = 0; m < array.sensors; ++m)
    if (interval_.live()[static_cast<std::size_t>(m)] == 0.0)
      for (SplitMatrix<double>* matrix : {&a_, &b_}) {
        matrix->re.row(m).setZero();
        matrix->im.row(m).setZero();
      }
  const auto find = [&](auto& innovation) {
    innovation.prepare(basis());
    for (Eigen::Index n = 0; n < columns; ++n)
      found_[static_cast<std::size_t>(n)] = {innovation(a_, b_, n), detail::real_product(b_, n, b_, n)};
  };
  if (options_.innovation == SubspaceAngleOptions::Innovation::ryu)
    find(ryu_);
  else
    find(projection_);
}

double SubspaceAngleTracker::variance(std::size_t n, double curvature) const {
  double variance = options_.sigma_rad * options_.sigma_rad;
  if (options_.sigma_from_subspace) {
    // Of MUSIC's angles (Stoica and Nehorai 1989), every signal taken to be as strong as their mean.
    const double snr = signal_power_ / noise_power_ / interval_.live_sensors();
    const double Ns = interval_.snapshots();
    variance += (1.0 + 1.0 / (snr * interval_.live_sensors())) / (2.0 * Ns * snr * curvature);
  }
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t other = 0; other < predicted_.size(); ++other)
    if (other != n) nearest = std::min(nearest, std::abs(predicted_[other].x()[0] - predicted_[n].x()[0]));
  constexpr double kNearest_rad = 1e-4;
  if (nearest < options_.inflate_within_rad) {
    const double factor = options_.inflate_within_rad / std::max(nearest, kNearest_rad);
    variance *= 1.0 + factor * factor;
  }
  return variance;
}

// Steps 2 to 5 for every target, and its record.
std::span<const StepRecord> SubspaceAngleTracker::publish(const Measurement& measurement, double dt_s, bool usable) {
  const LineArray array{interval_.sensors(), interval_.spacing_wavelengths()};
  const double lag_s = options_.lag_intervals * interval_.interval_s();
  const std::size_t N = filters_.size();
  const bool begins = N > 0 && records_.front().x.size() == 0;  // nothing was published of these yet

  for (std::size_t n = 0; n < N; ++n) {  // step 2, equations (16) and (17)
    predicted_[n] = filters_[n];
    StepRecord& record = records_[n];
    record.status = begins ? StepStatus::ok : StepStatus::coasted;
    if (dt_s > 0.0 && predicted_[n].predict(motion(), dt_s) == StepStatus::failed) record.status = StepStatus::failed;
    record.track = first_track_ + static_cast<int>(n);
    record.time_s = measurement.time_s;
    record.space = &angle_space();
    record.sensor = measurement.sensor;
    record.prediction = Prediction{predicted_[n].x(), predicted_[n].P()};
    record.innovation.reset();
    record.gain.reset();
  }
  if (usable) {
    find_innovations(array, lag_s);
    used_time_s_ = measurement.time_s;
  }
  for (std::size_t n = 0; n < N; ++n) {
    StepRecord& record = records_[n];
    Filter updated = predicted_[n];
    if (usable) {
      LaggedAngle model{lag_s, 1.0};
      const double angle_rad = expected_rad_[n];
      const auto& [found, b2] = found_[n];
      record.status = StepStatus::failed;
      if (std::isfinite(found.angle_rad) && found.curvature > kLeastCurvature * b2) {
        model.variance_rad2 = variance(n, found.curvature);
        const LaggedAngle::Vector z(angle_rad + found.angle_rad);
        const auto update = updated.update(model, z);  // step 4, equations (18) to (20)
        record.status = update.status;
        if (update.status == StepStatus::ok) {
          record.innovation = Innovation{z, update.nu, update.S, update.nis};
          record.gain.emplace(update.K);
        }
      }
      if (record.status == StepStatus::failed) ++guard_.counts.failed;
      filters_[n] = updated;
    }
    const bool is_inside = begins || is_in_sector(updated.x(), updated.P());
    if (is_inside && usable) known_[n] = updated;
    const Filter& published = is_inside ? updated : known_[n];
    record.x = published.x();
    record.P = published.P();
    if (is_inside) continue;
    record.status = StepStatus::failed;
    record.prediction = Prediction{record.x, record.P};
    record.innovation.reset();
    record.gain.reset();
  }
  find_neighbours(array, records_,
                  [&](std::size_t i, std::size_t j) { return records_[i].P(0, 0) + records_[j].P(0, 0); });
  return records_;
}

}  // namespace truebearing
