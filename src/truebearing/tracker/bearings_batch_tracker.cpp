// SPDX-License-Identifier: Apache-2.0
#include "truebearing/tracker/bearings_batch_tracker.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "truebearing/core/linear_algebra.hpp"
#include "truebearing/tma/residual_checks.hpp"
#include "truebearing/tracker/publishable.hpp"

namespace truebearing {
namespace {

constexpr std::size_t kReserved = 2048;  // bearings: beyond them a growing window allocates
constexpr std::size_t kEvents = 64;
constexpr double kUnheard_hz = 1e4;  // standard deviation of the f0 of a source that was not heard yet

TargetMotionBatchOptions solver_options(const BearingsBatchOptions& options) {
  const auto* own = std::get_if<TargetMotionBatchOptions>(&options.method);
  return own ? *own : TargetMotionBatchOptions{};
}

}  // namespace

BearingsBatchTracker::BearingsBatchTracker(BearingsBatchOptions options)
    : options_(std::move(options)),
      solver_(solver_options(options_)),
      frequency_solver_(options_.frequency ? options_.frequency->changes : FrequencyChangeOptions{}),
      frequencies_(options_.frequency ? options_.frequency->sound_mps : kSoundInWater_mps) {
  window_.reserve(kReserved);
  if (options_.frequency) frequencies_.reserve(kReserved);
  events_.reserve(kEvents);
  reset();
}

void BearingsBatchTracker::reset() {
  guard_ = {};
  window_.clear();
  frequencies_.clear();
  guess_.reset();
  prior_.reset();
  estimate_ = {};
  source_ = {};
  range_known_ = false;
  events_.clear();
  solved_ = 0;
  due_s_ = -std::numeric_limits<double>::infinity();
  record_ = {};
  record_.space = &space();
}

// The prior of this track, where guess and options make one.
void BearingsBatchTracker::believe(const Measurement& first, double sigma_rad, const SensorState& sensor) {
  const auto believe_velocity = [&](const Eigen::Vector2d& mean_mps, const Eigen::Matrix2d& covariance) {
    prior_.emplace();
    prior_->velocity_mps = mean_mps;
    prior_->velocity_information = inverse_of_positive<2>(covariance);
  };
  if (const auto* velocity = std::get_if<VelocityPrior>(&*options_.prior)) {
    const double variance = velocity->sigma_mps * velocity->sigma_mps;
    believe_velocity(Eigen::Vector2d::Zero(), variance * Eigen::Matrix2d::Identity());
    return;
  }
  const RangePrior& belief = std::get<RangePrior>(*options_.prior);
  if (!belief.suffices_with(guess_)) return;
  const GaussianState state = belief.state(first.z[0], sigma_rad, sensor, guess_);
  believe_velocity(state.x.tail<2>(), state.P.bottomRightCorner<2, 2>());
  const TruncatedNormal range = belief.range(guess_);
  prior_->range = BatchPrior::Range{range.mean, range.sigma, sensor.position_m, first.time_s};
}

void BearingsBatchTracker::add(const Measurement& measurement) {
  const SensorState sensor = measurement.sensor.value_or(SensorState{});
  const auto sigma = [&](Eigen::Index i, double otherwise) {
    return options_.sigma_factor * (measurement.sigma.size() > i ? measurement.sigma[i] : otherwise);
  };
  if (std::isfinite(measurement.z[0])) {
    const double sigma_rad = sigma(0, options_.sigma_rad);
    if (options_.prior && !prior_) believe(measurement, sigma_rad, sensor);
    window_.add(measurement.time_s, measurement.z[0], sigma_rad, sensor.position_m);
  }
  if (has_frequency(measurement))
    frequencies_.add(measurement.time_s, measurement.z[1], sigma(1, options_.frequency->sigma_hz), sensor);
  window_.drop_before(measurement.time_s - options_.window_s);
  frequencies_.drop_before(measurement.time_s - options_.window_s);
}

bool BearingsBatchTracker::has_frequency(const Measurement& measurement) const {
  return options_.frequency && measurement.z.size() == 2 && std::isfinite(measurement.z[1]) && measurement.z[1] > 0.0;
}

bool BearingsBatchTracker::is_due(double time_s) {
  constexpr double kRounding_s = 1e-6;
  if (options_.solve_at_s.empty()) {
    if (time_s < due_s_ - kRounding_s) return false;
    due_s_ = time_s + options_.solve_every_s;
    return true;
  }
  const std::size_t before = solved_;
  while (solved_ < options_.solve_at_s.size() && time_s >= options_.solve_at_s[solved_] - kRounding_s) ++solved_;
  return solved_ > before;
}

BatchEstimate BearingsBatchTracker::solve() {
  if (window_.size() < 3 || !(window_.last_time_s() > window_.first_time_s())) return {};
  if (options_.prior && !prior_) return {};
  if (const auto* cho = std::get_if<ChoOptions>(&options_.method)) return solve_cho(window_, *cho);
  Eigen::Vector4d warm = estimate_.x;
  warm.head<2>() += (window_.last_time_s() - estimate_.time_s) * warm.tail<2>();
  const Eigen::Vector4d* start = options_.warm_start && estimate_.found ? &warm : nullptr;
  if (!options_.frequency) return solver_.solve(window_, prior_, start);
  return frequency_solver_.solve(solver_, window_, frequencies_, prior_, start);
}

void BearingsBatchTracker::take(const BatchEstimate& estimate) {
  estimate_ = estimate;
  if (!options_.frequency) return;
  source_ = {};
  if (frequencies_.size() == 0)
    source_.variance = kUnheard_hz * kUnheard_hz;
  else
    source_ = frequencies_.source(frequency_solver_.last_level(), estimate.x, estimate.time_s);
}

// Each change once, though later solutions may place it a few frequencies from where the first did.
void BearingsBatchTracker::report_changes() {
  constexpr double kSamePlace = 5.0;
  if (frequencies_.size() < 2) return;
  const double length_s = frequencies_.time_s(frequencies_.size() - 1) - frequencies_.time_s(0);
  const double near_s = kSamePlace * length_s / static_cast<double>(frequencies_.size() - 1);
  for (const FrequencyChange& change : frequency_solver_.changes()) {
    const auto is_it = [&](const TrackEvent& event) {
      return event.kind == TrackEvent::Kind::source_changed && std::abs(event.time_s - change.time_s) <= near_s;
    };
    if (std::none_of(events_.begin(), events_.end(), is_it))
      events_.push_back({TrackEvent::Kind::source_changed, change.time_s, change.frequency_hz});
  }
}

// What came after the change is one course and speed again.
void BearingsBatchTracker::cut_at_manoeuvre() {
  constexpr std::size_t kFewest = 5;
  if (window_.size() < kFewest || !solver_.observability().observable()) return;
  const bool heard = options_.frequency && frequency_solver_.used_frequencies();
  const ResidualChecks checks = check_residuals(window_, estimate_, heard ? &frequencies_ : nullptr);
  if (!checks.manoeuvred) return;
  events_.push_back({TrackEvent::Kind::turn_began, checks.manoeuvre_s});
  window_.drop_before(checks.manoeuvre_s);
  frequencies_.drop_before(checks.manoeuvre_s);
}

std::span<const StepRecord> BearingsBatchTracker::step(const Measurement& measurement) {
  const bool has_bearing = (measurement.z.size() == 1 || measurement.z.size() == 2) && std::isfinite(measurement.z[0]);
  const StreamGuard::Verdict verdict = guard_.examine(measurement, has_bearing || has_frequency(measurement));
  record_.batch.reset();
  if (verdict == StreamGuard::Verdict::repeated || verdict == StreamGuard::Verdict::out_of_order) {
    set_status(StepStatus::rejected, record_);
    return estimate_.found ? std::span<const StepRecord>(&record_, 1) : std::span<const StepRecord>();
  }
  if (measurement.guess) guess_ = measurement.guess;
  if (verdict == StreamGuard::Verdict::usable) add(measurement);

  record_.status = StepStatus::coasted;
  // An empty row is no occasion: it leaves no trace.
  if (verdict == StreamGuard::Verdict::usable && is_due(measurement.time_s)) {
    const BatchEstimate estimate = solve();
    if (estimate.starts > 0)
      record_.batch = BatchOutcome{estimate.cost, estimate.iterations, estimate.starts, estimate.non_finite_starts};
    if (estimate.found) {
      take(estimate);
      const bool judged = std::holds_alternative<TargetMotionBatchOptions>(options_.method);
      const bool known = judged && solver_.observability().observable();
      record_.status = known || !judged || prior_ ? StepStatus::ok : StepStatus::unobservable;
      if (known && !range_known_) events_.push_back({TrackEvent::Kind::range_known, measurement.time_s});
      range_known_ = range_known_ || known;
      if (options_.frequency) report_changes();
      if (judged && options_.cut_at_manoeuvres) cut_at_manoeuvre();
    } else if (estimate.starts > 0) {
      ++guard_.counts.failed;
      record_.status = StepStatus::failed;
    }
  }
  if (!estimate_.found) return {};
  record_.time_s = measurement.time_s;
  record_.sensor = measurement.sensor;
  Eigen::Vector4d x = estimate_.x;
  Eigen::Matrix4d P = estimate_.P;
  const double t = measurement.time_s - estimate_.time_s;
  carry(t, x, P);
  record_.x = x;
  record_.P = P;
  if (options_.frequency) {
    // The f0 depends on the state as it was.
    SourceFrequency source = source_;
    source.per_state.tail<2>() -= t * source.per_state.head<2>();
    record_.x.conservativeResize(5);
    record_.x[4] = source.frequency_hz;
    record_.P = covariance_with(P, source);
  }
  set_status(record_.status, record_);
  return {&record_, 1};
}

}  // namespace truebearing
