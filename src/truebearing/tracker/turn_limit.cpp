// SPDX-License-Identifier: Apache-2.0
#include "truebearing/tracker/turn_limit.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <functional>
#include <stdexcept>
#include <utility>

#include "truebearing/core/angle.hpp"
#include "truebearing/motion/coordinated_turn.hpp"
#include "truebearing/tracker/publishable.hpp"

namespace truebearing {
namespace {

constexpr int kTurnsPerHypotheses = 10;
constexpr double kNegligible = 1e-12;  // a weight

// A turn and, behind it, a straight leg: no noise. The frequency stays.
struct TurnAndLeg {
  using Scalar = double;
  static constexpr int kStates = 5;
  using Matrix = Eigen::Matrix<double, 5, 5>;

  double turn_rate_radps, straight_s;

  Matrix F(double dt_s) const {
    Matrix whole = Matrix::Identity();
    whole.topLeftCorner<4, 4>() =
        detail::turn_transition(0.0, straight_s) * detail::turn_transition(turn_rate_radps, dt_s - straight_s);
    return whole;
  }
  Matrix Q(double) const { return Matrix::Zero(); }
};

}  // namespace

TurnLimit::TurnLimit(TurnLimitOptions options) : options_(std::move(options)), stream_({}, StreamId::particles) {
  if (options_.turn.is_course) throw std::invalid_argument("the limit knows turns by an angle");
  if (options_.hypotheses < kTurnsPerHypotheses) throw std::invalid_argument("the limit needs ten hypotheses");
  const auto kept = static_cast<std::size_t>(options_.hypotheses);
  const std::size_t most = 2 * kept + 2 * kept / kTurnsPerHypotheses + 1;
  hypotheses_.reserve(most);
  moved_.reserve(most);
  weights_.reserve(most);
  reset();
}

void TurnLimit::reset() {
  guard_ = {};
  hypotheses_.clear();
  record_ = {};
  record_.space = &space();
}

// Two estimates draw differently, and the same one the same.
void TurnLimit::take_over(double time_s, const BoundedVector& x, const BoundedMatrix& P) {
  hypotheses_.clear();
  time_s_ = time_s;
  if (x.size() != 5) return;
  stream_ = RandomStream({options_.seed, Role::evaluation, std::bit_cast<std::uint64_t>(x[0])}, StreamId::particles);
  hypotheses_.push_back({KalmanFilter<5>(x, P), 1.0});
}

// All hypotheses from the last used measurement to this time, in moved_.
void TurnLimit::move(double time_s) {
  moved_.clear();
  const double dt_s = time_s - time_s_;
  for (const Hypothesis& hypothesis : hypotheses_) {
    if (hypothesis.phase == Phase::before)
      wait(hypothesis, time_s);
    else if (hypothesis.phase == Phase::turning)
      turn(hypothesis, dt_s);
    else
      carry(hypothesis, 0.0, dt_s);
  }
}

// What has not turned yet: begins turns now, with the share that the family has of those that have not begun, and stays
// as it is. Begin, rate and angle are of a lattice of low discrepancy, shifted at random (Cranley and Patterson 1976).
void TurnLimit::wait(const Hypothesis& waiting, double time_s) {
  const VesselParameters::Turn& family = options_.turn;
  const double begun = family.time_s.share_below(time_s_), now = family.time_s.share_below(time_s);
  const double left = 1.0 - family.share * begun, mass = family.share * (now - begun);
  if (mass > 0.0) {
    const int turns = options_.hypotheses / kTurnsPerHypotheses;
    const double shift = stream_.uniform(), other_shift = stream_.uniform();
    for (int k = 0; k < turns; ++k) {
      const double u = (k + shift) / turns;
      const double v = std::fmod(other_shift + k * (std::numbers::phi - 1.0), 1.0);
      const double begin_s = std::clamp(family.time_s.quantile(begun + u * (now - begun)), time_s_, time_s);
      Hypothesis turning = waiting;
      if (turning.filter.predict(TurnAndLeg{0.0, begin_s - time_s_}, begin_s - time_s_) == StepStatus::failed) continue;
      turning.weight *= mass / left / turns;
      turning.phase = Phase::turning;
      // Port and starboard alike where either may be: the share of the rates is gone through twice.
      const bool to_port = family.either_side && v < 0.5;
      const double share = family.either_side ? std::fmod(2.0 * v, 1.0) : v;
      turning.rate_radps = radians(family.rate_degps.quantile(share)) * (to_port ? -1.0 : 1.0);
      turn(turning, time_s - begin_s);
    }
  }
  Hypothesis still = waiting;
  still.weight *= (left - mass) / left;
  carry(std::move(still), 0.0, time_s - time_s_);
}

// What turns: parts into one that ends within the step, where that may be, and one that goes on.
void TurnLimit::turn(Hypothesis turning, double dt_s) {
  const Distribution& angle = options_.turn.angle_deg;
  const double by_deg = degrees(std::abs(turning.rate_radps)) * dt_s;
  const double before = angle.share_below(turning.turned_deg), now = angle.share_below(turning.turned_deg + by_deg);
  const double ends = before < 1.0 ? (now - before) / (1.0 - before) : 1.0;
  if (ends > 0.0) {
    const double at_deg = angle.quantile(before + stream_.uniform() * (now - before)) - turning.turned_deg;
    const double turning_s = std::clamp(at_deg / std::max(by_deg, kNegligible), 0.0, 1.0) * dt_s;
    Hypothesis ended = turning;
    ended.phase = Phase::after;
    ended.weight *= ends;
    carry(std::move(ended), turning_s, dt_s - turning_s);
  }
  turning.weight *= 1.0 - ends;
  turning.turned_deg += by_deg;
  carry(std::move(turning), dt_s, 0.0);
}

void TurnLimit::carry(Hypothesis hypothesis, double turning_s, double straight_s) {
  if (!(hypothesis.weight > kNegligible)) return;
  const double rate_radps = turning_s > 0.0 ? hypothesis.rate_radps : 0.0;
  if (hypothesis.filter.predict(TurnAndLeg{rate_radps, straight_s}, turning_s + straight_s) == StepStatus::failed)
    return;
  moved_.push_back(std::move(hypothesis));
}

// False where no hypothesis could have led to the measurement.
bool TurnLimit::weigh(const Measurement& measurement) {
  const auto model = options_.sensor.model(measurement);
  const auto z = options_.sensor.value(measurement);
  double largest = -std::numeric_limits<double>::infinity();
  weights_.clear();
  for (Hypothesis& hypothesis : moved_) {
    const auto update = hypothesis.filter.update(
        model,
        model.has_bearing && model.has_frequency ? z : BearingFrequency<>::Vector(z.array().isNaN().select(0.0, z)));
    const double logarithm =
        update.status == StepStatus::failed
            ? -std::numeric_limits<double>::infinity()
            : std::log(hypothesis.weight) -
                  0.5 * (update.nis + std::log(update.S(0, 0) * update.S(1, 1) - update.S(0, 1) * update.S(1, 0)));
    weights_.push_back(logarithm);
    largest = std::max(largest, logarithm);
  }
  if (!std::isfinite(largest)) return false;
  double sum = 0.0;
  for (double& weight : weights_) sum += weight = std::exp(weight - largest);
  for (std::size_t i = 0; i < moved_.size(); ++i) moved_[i].weight = weights_[i] / sum;
  return true;
}

// From moved_ to hypotheses_: with c so that the sum of min(weight / c, 1) is their number, those above c stay, and of
// the others each stays with probability weight / c, as one of weight c.
void TurnLimit::thin() {
  const auto kept = static_cast<std::size_t>(options_.hypotheses);
  hypotheses_.clear();
  if (moved_.size() <= kept) {
    std::swap(hypotheses_, moved_);
    return;
  }
  weights_.clear();
  for (const Hypothesis& hypothesis : moved_) weights_.push_back(hypothesis.weight);
  std::sort(weights_.begin(), weights_.end(), std::greater<>());
  double rest = 1.0, c = 0.0;
  for (std::size_t above = 0; above < kept; ++above) {
    c = rest / static_cast<double>(kept - above);
    if (weights_[above] <= c) break;
    rest -= weights_[above];
  }
  double next = stream_.uniform() * c, sum = 0.0;
  for (Hypothesis& hypothesis : moved_) {
    if (hypothesis.weight <= c) {
      next -= hypothesis.weight;
      if (next > 0.0) continue;
      next += c;
      hypothesis.weight = c;
    }
    sum += hypothesis.weight;
    hypotheses_.push_back(hypothesis);
  }
  for (Hypothesis& hypothesis : hypotheses_) hypothesis.weight /= sum;
}

std::span<const StepRecord> TurnLimit::step(const Measurement& measurement) {
  const StreamGuard::Verdict verdict = guard_.examine(measurement, options_.sensor.has_value(measurement));
  if (is_lost()) return {};
  record_.sensor = measurement.sensor;
  if (verdict == StreamGuard::Verdict::repeated || verdict == StreamGuard::Verdict::out_of_order ||
      measurement.time_s < time_s_) {
    record_.time_s = measurement.time_s;
    record_.status = StepStatus::rejected;
    return {&record_, record_.x.size() > 0 ? 1u : 0u};
  }
  record_.time_s = measurement.time_s;
  if (verdict != StreamGuard::Verdict::usable) {
    // A missing measurement leaves no trace in what follows.
    const RandomStream kept = stream_;
    move(measurement.time_s);
    stream_ = kept;
    publish(StepStatus::coasted, moved_);
    return {&record_, 1};
  }
  move(measurement.time_s);
  time_s_ = measurement.time_s;
  if (weigh(measurement)) {
    thin();
    publish(StepStatus::ok, hypotheses_);
    if (record_.status == StepStatus::ok) return {&record_, 1};
  }
  ++guard_.counts.failed;
  hypotheses_.clear();
  return {};
}

void TurnLimit::publish(StepStatus status, const std::vector<Hypothesis>& of) {
  Eigen::Vector4d mean = Eigen::Vector4d::Zero();
  double turning = 0.0, sum = 0.0;
  for (const Hypothesis& hypothesis : of) {
    sum += hypothesis.weight;
    mean += hypothesis.weight * hypothesis.filter.x().head<4>();
    if (hypothesis.phase == Phase::turning) turning += hypothesis.weight;
  }
  mean /= sum;
  Eigen::Matrix4d P = Eigen::Matrix4d::Zero();
  for (const Hypothesis& hypothesis : of) {
    const Eigen::Vector4d off = hypothesis.filter.x().head<4>() - mean;
    P += hypothesis.weight / sum * (hypothesis.filter.P().topLeftCorner<4, 4>() + off * off.transpose());
  }
  record_.x = mean;
  record_.P = P;
  record_.mode_probabilities = Eigen::Vector2d(1.0 - turning / sum, turning / sum);
  set_status(status, record_);
}

}  // namespace truebearing
