// SPDX-License-Identifier: Apache-2.0
#include "truebearing/tracker/particle_limit.hpp"

#include <bit>
#include <cmath>
#include <stdexcept>

#include "truebearing/tracker/publishable.hpp"

namespace truebearing {
namespace {

constexpr double kResampleBelow = 0.5;  // effective particles, of all
constexpr double kEagerness = 2.0;      // of legs to end: manoeuvres that begin are what a cloud lacks particles of
/// A measurement farther off than chance explains (chi-square of two: once in e^(kLost / 2)) means that the likely
/// particles have died out.
constexpr double kLost = 40.0;

std::size_t particles_of(const ParticleLimitOptions& options) {
  if (options.particles < 1) throw std::invalid_argument("a particle filter needs particles");
  return static_cast<std::size_t>(options.particles);
}

}  // namespace

ParticleLimit::ParticleLimit(std::unique_ptr<AnySensor> sensor, ParticleLimitOptions options)
    : sensor_(std::move(sensor)),
      options_(std::move(options)),
      modes_(options_.flight, kEagerness),
      stream_({}, StreamId::particles),
      cloud_(particles_of(options_)),
      moved_(particles_of(options_)) {
  if (sensor_->size() != 2 || sensor_->states() != 4 || !sensor_->tells_position())
    throw std::invalid_argument("the limit is of measured positions in the plane");
  remembered_.reserve(kRemembered);
  reset();
}

void ParticleLimit::reset() {
  guard_ = {};
  begun_ = false;
  remembered_.clear();
  fresh_starts_ = 0;
  record_ = {};
  record_.space = &space();
  record_.track = -1;
}

// Two recordings draw different particles, and the same recording the same ones.
bool ParticleLimit::begin(const Measurement& measurement, double flown_s) {
  const PositionFix fix = *sensor_->fix(measurement);
  if (!fix.z.allFinite() || !fix.R.allFinite() || fix.z.cwiseAbs().maxCoeff() > kFarthest_m) return false;
  stream_ =
      RandomStream({options_.seed, Role::evaluation,
                    std::bit_cast<std::uint64_t>(fix.z[0]) ^ std::rotl(std::bit_cast<std::uint64_t>(fix.z[1]), 32)},
                   StreamId::particles);
  cloud_.begin(modes_, Eigen::Vector2d(fix.z), Eigen::Matrix2d(fix.R), flown_s, stream_);
  innovation_.reset();
  used_time_s_ = measurement.time_s;
  return true;
}

// Moves the cloud to a measurement and weighs it: false where that is nowhere near.
bool ParticleLimit::use(const Measurement& measurement) {
  moved_.move(cloud_, modes_, measurement.time_s - used_time_s_, stream_);
  const ParticleCloud::Moments expected = moved_.moments();
  prediction_.x = expected.x;
  prediction_.P = expected.P;
  const AnyMeasurement& any = sensor_->take(measurement, prediction_);
  const auto& taken = static_cast<const SizedMeasurement<2>&>(any);
  Innovation& innovation = innovation_.emplace();
  const Eigen::Matrix2d S = expected.P.topLeftCorner<2, 2>() + taken.R;
  const Eigen::Vector2d nu = taken.z - expected.x.head<2>();
  innovation.z = taken.z;
  innovation.nu = nu;
  innovation.S = S;
  innovation.nis = (S(1, 1) * nu[0] * nu[0] - 2.0 * S(0, 1) * nu[0] * nu[1] + S(0, 0) * nu[1] * nu[1]) /
                   (S(0, 0) * S(1, 1) - S(0, 1) * S(0, 1));
  if (!moved_.update(taken.z, taken.R)) return false;
  used_time_s_ = measurement.time_s;
  settle();
  return innovation.nis < kLost;
}

// What was moved becomes the cloud, with particles where the weight is.
void ParticleLimit::settle() {
  std::swap(cloud_, moved_);
  if (cloud_.effective() >= kResampleBelow * static_cast<double>(cloud_.size())) return;
  moved_.resample(cloud_, stream_);
  std::swap(cloud_, moved_);
}

// From the last measurements, of a flight that may be anywhere in its programme.
bool ParticleLimit::start_afresh() {
  ++fresh_starts_;
  const std::optional<Innovation> innovation = innovation_;
  const Prediction prediction = prediction_;
  if (begin(remembered_.front(), options_.flight_s))
    for (std::size_t k = 1; k < remembered_.size(); ++k) use(remembered_[k]);
  const bool is_there = used_time_s_ == remembered_.back().time_s || begin(remembered_.back(), options_.flight_s);
  innovation_ = innovation;
  prediction_ = prediction;
  return is_there;
}

std::span<const StepRecord> ParticleLimit::step(const Measurement& measurement) {
  const StreamGuard::Verdict verdict = guard_.examine(measurement, sensor_->has_value(measurement));
  record_.time_s = measurement.time_s;
  record_.sensor = measurement.sensor;
  record_.prediction.reset();
  record_.innovation.reset();
  if (verdict == StreamGuard::Verdict::repeated || verdict == StreamGuard::Verdict::out_of_order) {
    record_.status = StepStatus::rejected;
    return {&record_, begun_ ? 1u : 0u};
  }
  const bool usable = verdict == StreamGuard::Verdict::usable;
  const double dt_s = measurement.time_s - used_time_s_;
  if (begun_ && usable && dt_s > options_.flight_s) begun_ = false;
  if (!begun_) {
    if (!usable) return {};
    remembered_.clear();
    ++record_.track;
    const bool first = record_.track == 0;
    if (!begin(measurement, first ? options_.flown_s : options_.flight_s)) return give_up();
    begun_ = true;
    remembered_.push_back(measurement);
    return publish(StepStatus::ok, cloud_) ? std::span<const StepRecord>(&record_, 1) : give_up();
  }
  if (!usable) {
    // The cloud stays at its last used measurement: a missing one leaves no trace in what follows.
    RandomStream aside = stream_;
    moved_.move(cloud_, modes_, std::min(dt_s, options_.flight_s), aside);
    publish(StepStatus::coasted, moved_);
    return {&record_, 1};
  }
  if (remembered_.size() == kRemembered) remembered_.erase(remembered_.begin());
  remembered_.push_back(measurement);
  if (!use(measurement) && !start_afresh()) return give_up();
  record_.prediction = prediction_;
  record_.innovation = innovation_;
  return publish(StepStatus::ok, cloud_) ? std::span<const StepRecord>(&record_, 1) : give_up();
}

bool ParticleLimit::publish(StepStatus status, const ParticleCloud& cloud) {
  const ParticleCloud::Moments moments = cloud.moments();
  record_.x = moments.x;
  record_.P = moments.P;
  record_.mode_probabilities = cloud.mode_probabilities();
  set_status(status, record_);
  return record_.status != StepStatus::failed;
}

std::span<const StepRecord> ParticleLimit::give_up() {
  ++guard_.counts.failed;
  begun_ = false;
  return {};
}

}  // namespace truebearing
