#include "truebearing/tracker/bearings_batch_tracker.hpp"

#include <Eigen/Cholesky>
#include <utility>

#include "truebearing/tma/residual_checks.hpp"

namespace truebearing {
namespace {

constexpr std::size_t kReserved = 2048;  // bearings: beyond them a growing window allocates

BearingsOnlyBatchOptions solver_options(const BearingsBatchOptions& options) {
  const auto* own = std::get_if<BearingsOnlyBatchOptions>(&options.method);
  return own ? *own : BearingsOnlyBatchOptions{};
}

}  // namespace

BearingsBatchTracker::BearingsBatchTracker(BearingsBatchOptions options)
    : options_(std::move(options)), solver_(solver_options(options_)) {
  window_.reserve(kReserved);
  reset();
}

void BearingsBatchTracker::reset() {
  guard_ = {};
  window_.clear();
  guess_.reset();
  prior_.reset();
  estimate_ = {};
  manoeuvres_s_.clear();
  solved_ = 0;
  due_s_ = -std::numeric_limits<double>::infinity();
  record_ = {};
  record_.space = &plane_space();
}

// The prior of this track, where guess and options make one.
void BearingsBatchTracker::believe(const Measurement& first, double sigma_rad, const SensorState& sensor) {
  const RangePrior& belief = *options_.prior;
  const bool of_range = belief.range_m != 0.0;
  if (of_range && !belief.suffices_with(guess_)) return;
  const std::optional<TargetGuess> guess = of_range ? guess_ : std::nullopt;
  const GaussianState state = belief.state(first.z[0], sigma_rad, sensor, guess);
  prior_.emplace();
  prior_->velocity_mps = state.x.tail<2>();
  prior_->velocity_information = state.P.bottomRightCorner<2, 2>().llt().solve(Eigen::Matrix2d::Identity());
  if (!of_range) return;
  const TruncatedNormal range = belief.range(guess);
  prior_->range = BatchPrior::Range{range.mean, range.sigma, sensor.position_m, first.time_s};
}

void BearingsBatchTracker::add(const Measurement& measurement) {
  const SensorState sensor = measurement.sensor.value_or(SensorState{});
  const double sigma_rad =
      options_.sigma_factor * (measurement.sigma.size() > 0 ? measurement.sigma[0] : options_.sigma_rad);
  if (options_.prior && !prior_) believe(measurement, sigma_rad, sensor);
  window_.add(measurement.time_s, measurement.z[0], sigma_rad, sensor.position_m);
  window_.drop_before(measurement.time_s - options_.window_s);
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
  return solver_.solve(window_, prior_, options_.warm_start && estimate_.found ? &warm : nullptr);
}

// What came after the change is one course and speed again.
void BearingsBatchTracker::cut_at_manoeuvre() {
  constexpr std::size_t kFewest = 5;
  if (window_.size() < kFewest || !solver_.observability().observable()) return;
  const ResidualChecks checks = check_residuals(window_, estimate_);
  if (!checks.manoeuvred) return;
  manoeuvres_s_.push_back(checks.manoeuvre_s);
  window_.drop_before(checks.manoeuvre_s);
}

std::span<const StepRecord> BearingsBatchTracker::step(const Measurement& measurement) {
  const StreamGuard::Verdict verdict = guard_.examine(measurement);
  record_.batch.reset();
  if (verdict == StreamGuard::Verdict::repeated || verdict == StreamGuard::Verdict::out_of_order) {
    record_.status = StepStatus::rejected;
    return estimate_.found ? std::span<const StepRecord>(&record_, 1) : std::span<const StepRecord>();
  }
  if (measurement.guess) guess_ = measurement.guess;
  if (verdict == StreamGuard::Verdict::usable && measurement.z.size() == 1) add(measurement);

  record_.status = StepStatus::coasted;
  if (is_due(measurement.time_s)) {
    const BatchEstimate estimate = solve();
    if (estimate.starts > 0)
      record_.batch = BatchOutcome{estimate.cost, estimate.iterations, estimate.starts, estimate.non_finite_starts};
    if (estimate.found) {
      estimate_ = estimate;
      const bool judged = std::holds_alternative<BearingsOnlyBatchOptions>(options_.method);
      const bool open = judged && !prior_ && !solver_.observability().observable();
      record_.status = open ? StepStatus::unobservable : StepStatus::ok;
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
  carry(measurement.time_s - estimate_.time_s, x, P);
  record_.x = x;
  record_.P = P;
  return {&record_, 1};
}

}  // namespace truebearing
