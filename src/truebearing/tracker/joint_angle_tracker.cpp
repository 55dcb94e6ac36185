// SPDX-License-Identifier: Apache-2.0
#include "truebearing/tracker/joint_angle_tracker.hpp"

#include <algorithm>
#include <cmath>

#include "truebearing/array/direction_finding.hpp"
#include "truebearing/core/angle.hpp"
#include "truebearing/tracker/snapshot_guard.hpp"

namespace truebearing {
namespace {

constexpr double kStartSigma_rad = 0.087;  // of the angles that a spectrum gives: no more than which peak is meant
constexpr double kStartLogPowerSigma = 2.0;
constexpr int kGrid = 128;
constexpr double kEndFireSine = 0.99;
constexpr int kMostNewcomers = 4;  // in one interval
constexpr int kCandidateAge = 3;
constexpr double kClose = 0.5;  // resolutions of the array
constexpr int kCloseHits = 3;

// Angle and rate of target n, lead_s later.
void marginal(const JointAngleState& state, int n, double lead_s, BoundedVector& x, BoundedMatrix& P) {
  const int r = 2 * state.targets() + n;
  const double q = state.q[n], p = state.P(n, n), c = state.P(n, r), v = state.P(r, r);
  x.resize(2);
  P.resize(2, 2);
  x << state.x[n] + lead_s * state.x[r], state.x[r];
  P(0, 0) = p + 2.0 * lead_s * c + lead_s * lead_s * v + q * lead_s * lead_s * lead_s / 3.0;
  P(0, 1) = P(1, 0) = c + lead_s * v + q * lead_s * lead_s / 2.0;
  P(1, 1) = v + q * lead_s;
}

// Of the targets' time from the end of an interval.
double middle_of(const Interval& interval, bool moving) {
  if (!moving || interval.block_snapshots() == 0) return 0.0;
  const double Ns = interval.block_snapshots();
  return -0.5 * (Ns - 1.0) / Ns * interval.interval_s();
}

}  // namespace

JointAngleTracker::JointAngleTracker(JointAngleOptions options) : options_(std::move(options)) {
  options_.hypotheses.update.moving = options_.moving_blocks > 0;
  for (int g = 0; g < kGrid; ++g) grid_rad_.push_back(std::asin(kEndFireSine * (2.0 * g / (kGrid - 1.0) - 1.0)));
  reset();
}

void JointAngleTracker::reset() {
  guard_ = {};
  started_ = false;
  next_track_ = 0;
  tracks_.clear();
  tracks_.reserve(kMaxSignals);
  candidates_.clear();
  candidates_.reserve(kMaxSignals + kMostNewcomers);
  events_.clear();
  records_.assign(kMaxSignals, StepRecord{});
}

std::span<const StepRecord> JointAngleTracker::step(const Measurement& measurement) {
  const StreamGuard::Verdict verdict = examine_snapshots(guard_, measurement, interval_);
  if (verdict == StreamGuard::Verdict::repeated || verdict == StreamGuard::Verdict::out_of_order) {
    refuse(records_);
    return {records_.data(), started_ ? tracks_.size() : 0};
  }
  if (verdict == StreamGuard::Verdict::missing) {
    if (!started_) return {};
    return publish(measurement, StepStatus::coasted);
  }
  real_.take(interval_, std::max(options_.moving_blocks, 1));
  const double dt_s = measurement.time_s - used_time_s_;
  if (!started_ || is_lost(dt_s)) return begin_afresh(measurement);
  if (!hypotheses_.update(real_, dt_s, middle_of(interval_, options_.moving_blocks > 0))) {
    ++guard_.counts.failed;
    return publish(measurement, StepStatus::failed);
  }
  if (is_lost(0.0)) return begin_afresh(measurement);
  used_time_s_ = measurement.time_s;
  if (!options_.noise_power || options_.lifetimes) {
    const JointAngleState& best = hypotheses_.best().state;
    const SignalVector m = best.x.head(2 * best.targets()), rate = best.x.tail(best.targets());
    hypotheses_.scoring().likelihood().evaluate(real_, m, options_.moving_blocks > 0 ? &rate : nullptr,
                                                middle_of(interval_, options_.moving_blocks > 0), noise_power_);
    follow_noise();
  }
  publish(measurement, StepStatus::ok);
  if (options_.lifetimes) {
    end_tracks(measurement.time_s);
    begin_tracks(measurement.time_s);
    return publish(measurement, StepStatus::ok);
  }
  return {records_.data(), tracks_.size()};
}

// All targets as new ones, from this interval.
std::span<const StepRecord> JointAngleTracker::begin_afresh(const Measurement& measurement) {
  tracks_.clear();
  candidates_.clear();
  started_ = begin(measurement.time_s);
  if (!started_) {
    ++guard_.counts.failed;
    return {};
  }
  used_time_s_ = measurement.time_s;
  return publish(measurement, StepStatus::ok);
}

// Whether, dt_s after the last interval that was used, a target is outside the array's sector or anywhere in it.
bool JointAngleTracker::is_lost(double dt_s) const {
  BoundedVector x;
  BoundedMatrix P;
  for (int n = 0; n < static_cast<int>(tracks_.size()); ++n) {
    marginal(hypotheses_.best().state, n, dt_s, x, P);
    if (!is_in_sector(x, P)) return true;
  }
  return false;
}

// Angles where the spectrum of the first interval has them, or where a rotation of the array has: the likelier of the
// two after scoring.
bool JointAngleTracker::begin(double time_s) {
  Eigen::MatrixXcd R;
  sample_covariance(interval_, R);
  const LineArray array{interval_.sensors(), interval_.spacing_wavelengths()};
  const SignalSubspace whole = signal_subspace(R, 0);
  int N = 0;
  if (const int* given = std::get_if<int>(&options_.targets))
    N = *given;
  else
    N = source_count(whole.eigenvalues, interval_.snapshots(), std::get<OrderCriterion>(options_.targets));
  if (N >= interval_.sensors()) return false;  // more than the array could ever tell apart
  N = std::min({N, kMaxSignals, interval_.live_sensors() - 1});
  noise_power_ = options_.noise_power.value_or(std::max(
      whole.eigenvalues.segment(interval_.sensors() - interval_.live_sensors(), interval_.live_sensors() - N).mean(),
      1e-300));
  options_.hypotheses.update.noise_power = noise_power_;

  const Eigen::MatrixXcd E = signal_subspace(R, N).basis;
  std::optional<JointAngleState> best;
  double best_log_likelihood = 0.0;
  for (const std::vector<double>& angles : {music_angles(array, E), esprit_angles(array, E)}) {
    if (static_cast<int>(angles.size()) != N) continue;
    double log_likelihood = 0.0;
    std::optional<JointAngleState> state = state_from(angles, R, log_likelihood);
    if (!state || (best && log_likelihood <= best_log_likelihood)) continue;
    best = std::move(state);
    best_log_likelihood = log_likelihood;
  }
  if (!best) return false;
  hypotheses_.begin(options_.hypotheses, *best);
  for (int n = 0; n < N; ++n) {
    tracks_.push_back({next_track_++});
    if (options_.lifetimes) events_.push_back({TrackEvent::Kind::track_began, time_s, double(tracks_.back().number)});
  }
  return true;
}

std::optional<JointAngleState> JointAngleTracker::state_from(const std::vector<double>& angles,
                                                             const Eigen::MatrixXcd& R, double& log_likelihood) {
  const int N = static_cast<int>(angles.size()), M = interval_.sensors();
  const LineArray array{M, interval_.spacing_wavelengths()};
  JointAngleState prior;
  prior.x.setZero(3 * N);
  prior.P.setZero(3 * N, 3 * N);
  prior.q.setConstant(N, options_.hypotheses.motion.q0);
  prior.innovations.setZero(N);
  const double live = interval_.live_sensors();
  for (int n = 0; n < N; ++n) {
    Eigen::VectorXcd a(M);
    for (int m = 0; m < M; ++m) a[m] = std::polar(1.0, array.phase_step(angles[static_cast<std::size_t>(n)]) * m);
    const double beam = (a.adjoint() * R * a).value().real() / (live * live);  // power + noise / M
    prior.x[n] = angles[static_cast<std::size_t>(n)];
    prior.x[N + n] = std::log(std::max(beam - noise_power_ / live, 0.1 * noise_power_ / live));
    prior.P(n, n) = kStartSigma_rad * kStartSigma_rad;
    prior.P(N + n, N + n) = kStartLogPowerSigma * kStartLogPowerSigma;
    prior.P(2 * N + n, 2 * N + n) = options_.rate_sigma_radps * options_.rate_sigma_radps;
  }
  constexpr int kStartIterations = 20;
  JointAngleUpdate::Options update = options_.hypotheses.update;
  update.iterations = kStartIterations;
  JointAngleState state;
  if (!hypotheses_.scoring().run(prior, real_, middle_of(interval_, options_.moving_blocks > 0), prior.x.head(2 * N),
                                 update, state))
    return std::nullopt;
  log_likelihood = hypotheses_.scoring().likelihood().log_likelihood();

  sort_targets(state);
  return state;
}

void JointAngleTracker::follow_noise() {
  if (options_.noise_power) return;
  const double residual = hypotheses_.scoring().likelihood().residual_power();
  if (std::isfinite(residual) && residual > 0.0) noise_power_ += options_.noise_alpha * (residual - noise_power_);
  hypotheses_.set_noise_power(noise_power_);
}

// Of two targets that stand close together neither is heard beside the other: they are given longer.
void JointAngleTracker::end_tracks(double time_s) {
  const JointAngleOptions::Lifetimes& lifetimes = *options_.lifetimes;
  const AngleLikelihood& likelihood = hypotheses_.scoring().likelihood();
  const LineArray array{interval_.sensors(), interval_.spacing_wavelengths()};
  const auto are_close = [&](std::size_t i, std::size_t j) {
    const JointAngleState& best = hypotheses_.best().state;
    return std::abs(array.distance(best.angle(static_cast<int>(i)), best.angle(static_cast<int>(j)))) < kClose;
  };
  const auto is_gone = [&](std::size_t t) {
    bool close = false;
    for (std::size_t other = 0; other < tracks_.size(); ++other) close |= other != t && are_close(other, t);
    return tracks_[t].misses >= lifetimes.end_misses + (close ? lifetimes.close_misses : 0);
  };
  for (std::size_t t = 0; t < tracks_.size(); ++t) {
    tracks_[t].presence = likelihood.presence(static_cast<int>(t));
    tracks_[t].misses = tracks_[t].presence < lifetimes.end_presence ? tracks_[t].misses + 1 : 0;
  }
  // The least heard first; without it, those that it was close to are heard by themselves.
  for (;;) {
    std::size_t gone = tracks_.size();
    for (std::size_t t = 0; t < tracks_.size(); ++t)
      if (is_gone(t) && (gone == tracks_.size() || tracks_[t].presence < tracks_[gone].presence)) gone = t;
    if (gone == tracks_.size()) return;
    for (std::size_t t = 0; t < tracks_.size(); ++t)
      if (t != gone && are_close(t, gone)) tracks_[t].misses = 0;
    hypotheses_.change([&](AngleHypothesis& hypothesis) {
      remove_target(hypothesis.state, static_cast<int>(gone));
      remove_target(hypothesis.prior, static_cast<int>(gone));
    });
    events_.push_back({TrackEvent::Kind::track_ended, time_s, static_cast<double>(tracks_[gone].number)});
    tracks_.erase(tracks_.begin() + static_cast<std::ptrdiff_t>(gone));
  }
}

// What is heard often enough near the same place begins a track.
void JointAngleTracker::begin_tracks(double time_s) {
  const JointAngleOptions::Lifetimes& lifetimes = *options_.lifetimes;
  const LineArray array{interval_.sensors(), interval_.spacing_wavelengths()};
  const bool moving = options_.moving_blocks > 0;
  const double middle_s = middle_of(interval_, moving);
  for (Candidate& candidate : candidates_) ++candidate.age;
  std::erase_if(candidates_, [](const Candidate& candidate) { return candidate.age >= kCandidateAge; });

  const JointAngleState& best = hypotheses_.best().state;
  int N = best.targets();
  SignalVector m = best.x.head(2 * N), rate = best.x.tail(N);
  AngleLikelihood::Newcomer confirmed[kMostNewcomers];
  int count = 0;
  for (int found = 0; found < kMostNewcomers && N < kMaxSignals; ++found) {
    const AngleLikelihood::Newcomer heard = hypotheses_.scoring().likelihood().search(
        real_, m, moving ? &rate : nullptr, middle_s, noise_power_, grid_rad_);
    if (heard.presence < lifetimes.begin_presence) break;
    const auto again = std::find_if(candidates_.begin(), candidates_.end(), [&](const Candidate& candidate) {
      return std::abs(array.distance(candidate.heard.angle_rad, heard.angle_rad)) < 1.0;
    });
    bool leftover = false;  // what the grid left of one that was heard in this interval
    for (int n = best.targets(); n < N; ++n) leftover |= std::abs(array.distance(m[n], heard.angle_rad)) < 1.0;
    if (!leftover) {
      const int hits = again == candidates_.end() ? 1 : again->hits + 1;
      if (again != candidates_.end()) candidates_.erase(again);
      bool close = false;
      for (int n = 0; n < best.targets(); ++n) close |= std::abs(array.distance(m[n], heard.angle_rad)) < kClose;
      if (hits >= (close ? std::max(kCloseHits, lifetimes.begin_hits) : lifetimes.begin_hits))
        confirmed[count++] = heard;
      else
        candidates_.push_back({heard, hits});
    }
    // What else there is, this one explained.
    SignalVector more(2 * N + 2), rates(N + 1);
    more << m.head(N), heard.angle_rad, m.tail(N), heard.log_power;
    rates << rate, 0.0;
    m = more;
    rate = rates;
    ++N;
  }
  for (int i = 0; i < count; ++i) add_target(confirmed[i], time_s);
}

void JointAngleTracker::add_target(const AngleLikelihood::Newcomer& heard, double time_s) {
  const LineArray array{interval_.sensors(), interval_.spacing_wavelengths()};
  NewTarget target;
  target.angle_rad = heard.angle_rad;
  target.angle_sigma_rad = 0.5 * array.resolution_sine() / std::max(std::cos(heard.angle_rad), 0.1);
  target.log_power = heard.log_power;
  target.log_power_sigma = 1.0;
  target.rate_sigma_radps = options_.rate_sigma_radps;
  target.q = options_.hypotheses.motion.q0;
  hypotheses_.change([&](AngleHypothesis& hypothesis) {
    truebearing::add_target(hypothesis.state, target);
    truebearing::add_target(hypothesis.prior, target);
  });
  tracks_.push_back({next_track_++});
  events_.push_back({TrackEvent::Kind::track_began, time_s, static_cast<double>(tracks_.back().number)});
}

std::span<const StepRecord> JointAngleTracker::publish(const Measurement& measurement, StepStatus status) {
  const AngleHypothesis& best = hypotheses_.best();
  const double lead_s = -middle_of(interval_, options_.moving_blocks > 0);
  double coasted_s = measurement.time_s - used_time_s_;
  if (is_lost(coasted_s)) {  // what is known of it is what was known then
    coasted_s = 0.0;
    status = StepStatus::failed;
  }
  for (std::size_t t = 0; t < tracks_.size(); ++t) {
    const int n = static_cast<int>(t);
    StepRecord& record = records_[t];
    record.track = tracks_[t].number;
    record.time_s = measurement.time_s;
    record.status = status;
    record.space = &angle_space();
    record.sensor = measurement.sensor;
    record.innovation.reset();
    record.gain.reset();
    Prediction& prediction = record.prediction.emplace();
    marginal(best.state, n, lead_s + coasted_s, record.x, record.P);
    const EquivalentInnovation equivalent = equivalent_innovation(best.prior, best.state, n);
    if (status != StepStatus::ok || equivalent.gain <= kLeastGain) {  // or it has just begun
      prediction = {record.x, record.P};
      continue;
    }
    marginal(best.prior, n, lead_s, prediction.x, prediction.P);
    Innovation& innovation = record.innovation.emplace();
    innovation.nu = BoundedVector::Constant(1, equivalent.nu_rad);
    innovation.z = BoundedVector::Constant(1, prediction.x[0] + equivalent.nu_rad);
    innovation.S = BoundedMatrix::Constant(1, 1, equivalent.S_rad2);
    innovation.nis = equivalent.nis();
    record.gain.emplace(prediction.P.col(0) / equivalent.S_rad2);
  }
  const std::span<StepRecord> records(records_.data(), tracks_.size());
  const LineArray array{interval_.sensors(), interval_.spacing_wavelengths()};
  find_neighbours(array, records, [&](std::size_t i, std::size_t j) {
    const Eigen::Index a = static_cast<Eigen::Index>(i), b = static_cast<Eigen::Index>(j);
    return best.state.P(a, a) + best.state.P(b, b) - 2.0 * best.state.P(a, b);
  });
  return records;
}

}  // namespace truebearing
