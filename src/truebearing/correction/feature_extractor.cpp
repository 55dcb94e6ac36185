// SPDX-License-Identifier: Apache-2.0
#include "truebearing/correction/feature_extractor.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

#include "truebearing/core/constants.hpp"
#include "truebearing/core/error.hpp"
#include "truebearing/correction/feature_check.hpp"

namespace truebearing {
namespace {

// Most measured vectors are of two components: written and read as one, what is read just after it was written need
// not wait for the memory.
auto first_two(BoundedVector& v) {
  return Eigen::Map<Eigen::Vector2d, Eigen::Aligned16>(v.data());
}
auto first_two(const BoundedVector& v) {
  return Eigen::Map<const Eigen::Vector2d, Eigen::Aligned16>(v.data());
}

// e of an innovation: each component over its own standard deviation. In a frame that turns with the target it must not
// matter which way the axes of the plane point, so that there e = S^-1/2 nu with the symmetric root, which turns as nu
// does; where the components are not correlated the two are the same. Up, which does not turn, is by itself.
void normalise(const Innovation& innovation, Frame frame, BoundedVector& e) {
  const BoundedMatrix& S = innovation.S;
  const Eigen::Index m = S.rows();
  const bool turns = frame != Frame::state && (m == 2 || m == 3) && S(0, 1) != 0.0;
  e.resize(m);
  if (m == 2 && !turns) {
    first_two(e) = first_two(innovation.nu).cwiseQuotient(Eigen::Vector2d(S(0, 0), S(1, 1)).cwiseSqrt());
    return;
  }
  for (Eigen::Index i = turns ? 2 : 0; i < m; ++i) e[i] = innovation.nu[i] / std::sqrt(S(i, i));
  if (!turns) return;
  // S^1/2 = (S + s I) / t with s = sqrt(det S), t = sqrt(tr S + 2 s).
  const double s = std::sqrt(std::max(S(0, 0) * S(1, 1) - S(0, 1) * S(1, 0), 0.0));
  const double t = std::sqrt(S(0, 0) + S(1, 1) + 2.0 * s);
  const double a = S(0, 0) + s, b = S(0, 1), c = S(1, 1) + s, scale = t / (a * c - b * b);
  e[0] = scale * (c * innovation.nu[0] - b * innovation.nu[1]);
  e[1] = scale * (a * innovation.nu[1] - b * innovation.nu[0]);
}

// Whether such a feature is a component of a vector that is remembered.
bool is_remembered(FeatureKind kind) {
  return kind == FeatureKind::residual || kind == FeatureKind::prediction_difference ||
         kind == FeatureKind::innovation || kind == FeatureKind::innovation_average;
}

// Whether a feature of this kind has a memory.
bool remembers(FeatureKind kind) {
  constexpr std::array kOthers{FeatureKind::log_nis_average, FeatureKind::log_mean_nis, FeatureKind::log_interval,
                               FeatureKind::frame_turn,      FeatureKind::speed_change, FeatureKind::velocity_change};
  return is_remembered(kind) || std::find(kOthers.begin(), kOthers.end(), kind) != kOthers.end();
}

constexpr double kLeastRange_m = 1.0;

// Of states that have no plane, and no feature that wants this, it is some number.
double log_range(const BoundedVector& x, const SensorState& own) {
  const Eigen::Index m = std::min<Eigen::Index>(x.size(), 2);
  return std::log(std::max((x.head(m) - own.position_m.head(m)).norm(), kLeastRange_m));
}

}  // namespace

FeatureExtractor::FeatureExtractor(std::vector<FeatureSpec> features, const StateSpace& space, Frame frame,
                                   const BlocksOf& blocks_of)
    : frame_(frame), features_(std::move(features)) {
  const StateSpace& components = space_in(frame, space);
  if (features_.empty() || features_.size() > FuzzyNetwork::kMaxInputs)
    throw InputError("features", fmt::format("there are {}", features_.size()),
                     fmt::format("1 to {}", FuzzyNetwork::kMaxInputs));
  Eigen::Index place = 0;
  for (const FeatureSpec& feature : features_) {
    check_feature(feature, space, components, blocks_of);
    int companion = -1;
    if (!feature.companion.empty()) {
      const auto known = std::find(companions_.begin(), companions_.end(), feature.companion);
      companion = static_cast<int>(known - companions_.begin());
      if (known == companions_.end()) companions_.push_back(feature.companion);
    }
    wants_sigma_ |= feature.scale_is_sigma || feature.kind == FeatureKind::log_sigma;
    wants_gain_ |= feature.kind == FeatureKind::gain;
    const bool is_average = feature.kind == FeatureKind::innovation_average;
    const int component = std::max(components.component_index(feature.component), 0);
    const std::size_t memory = memory_of(feature.kind, companion, feature.alpha, feature.mode - 1);
    if (is_remembered(feature.kind))
      remembered_.push_back(
          {place, memory, component, is_average ? std::sqrt(feature.alpha / (2.0 - feature.alpha)) : 1.0});
    else
      terms_.push_back({place, feature.kind, component, companion, memory, feature.offset, feature.scale,
                        feature.scale_is_sigma, feature.mode - 1, feature.sensor - 1});
    ++place;
  }
}

// The place of what a feature of that kind remembers, which several may share.
std::size_t FeatureExtractor::memory_of(FeatureKind kind, int companion, double alpha, int mode) {
  if (!remembers(kind)) return 0;
  const auto known = std::find_if(memories_.begin(), memories_.end(), [&](const Memory& memory) {
    return memory.kind == kind && memory.companion == companion && memory.alpha == alpha && memory.mode == mode;
  });
  const auto place = static_cast<std::size_t>(known - memories_.begin());
  if (known == memories_.end()) memories_.push_back({kind, companion, alpha, mode});
  return place;
}

void FeatureExtractor::reset() {
  track_ = -1;
}

void FeatureExtractor::begin_track(const StepRecord& base) {
  track_ = base.track;
  began_s_ = base.time_s;
  log_first_range_ = log_range(base.x, base.sensor.value_or(SensorState{}));
  steps_ = 0.0;
  gain_.resize(0, 0);
  interval_memory_.reset();
  for (Memory& memory : memories_) {
    memory.value = BoundedVector::Zero(1);
    memory.used = 0.0;
  }
}

void FeatureExtractor::extract(const StepRecord& base, std::span<const StepRecord* const> companions,
                               Features& features) {
  if (base.track != track_) begin_track(base);
  interval_memory_.take(base);
  if (base.status == StepStatus::ok) steps_ += 1.0;
  if (wants_gain_ && base.status == StepStatus::ok && base.gain) gain_ = *base.gain;
  rotation_ = FrameRotation(frame_, base.x, base.sensor);
  if (wants_sigma_) sigma_ = rotation_.variances(base.P).cwiseSqrt();
  normalised_of_ = nullptr;
  const auto record_of = [&](int companion) {
    return companion < 0 ? &base : companions[static_cast<std::size_t>(companion)];
  };
  const auto is_known = [&](const StepRecord* record) { return record && record->x.size() == base.x.size(); };
  for (Memory& memory : memories_) {
    const StepRecord* record = record_of(memory.companion);
    if (record) remember(memory, *record);
    if (is_remembered(memory.kind)) turn(memory, is_known(record));
  }
  features.resize(size());
  for (const RememberedTerm& term : remembered_)
    features[term.place] = memories_[term.memory].in_frame[static_cast<std::size_t>(term.component)] / term.deviation;
  for (const Term& term : terms_) {
    const StepRecord* record = record_of(term.companion);
    features[term.place] = is_known(record) ? value(term, base, term.companion < 0 ? nullptr : record) : kNaN;
  }
}

// Of the step's rotation; no number where it is not known whose memory it is.
void FeatureExtractor::turn(Memory& memory, bool is_known) const {
  const Eigen::Index m = memory.value.size();
  if (is_known && m == 2 && memory.framed == 2) {  // as most are
    Eigen::Vector2d turned = first_two(memory.value);
    rotation_.turn(turned);
    memory.in_frame[0] = turned[0];
    memory.in_frame[1] = turned[1];
    return;
  }
  memory.framed = is_known ? m : -1;
  memory.in_frame.fill(is_known ? 0.0 : kNaN);
  if (!is_known || (rotation_.rotates() && m < 2)) return;
  Eigen::Map<BoundedVector> turned(memory.in_frame.data(), m);
  for (Eigen::Index i = 0; i < m; ++i) turned[i] = memory.value[i];
  rotation_.turn(turned);
}

// Takes from a step in which the measurement was used what later steps want to know of it.
void FeatureExtractor::remember(Memory& memory, const StepRecord& record) {
  if (record.status != StepStatus::ok || !record.innovation) return;
  const Innovation& innovation = *record.innovation;
  BoundedVector& value = memory.value;
  memory.used += 1.0;
  switch (memory.kind) {
    case FeatureKind::residual:
      value = innovation.z - record.x.head(innovation.z.size());
      break;
    case FeatureKind::prediction_difference:
      if (record.prediction) value = record.prediction->x - record.x;
      break;
    case FeatureKind::innovation:
    case FeatureKind::innovation_average: {
      const double alpha = memory.kind == FeatureKind::innovation ? 1.0 : memory.alpha;
      const BoundedVector& e = normalised_innovation(record);
      if (value.size() != e.size()) value = BoundedVector::Zero(e.size());
      if (alpha == 1.0)
        value = e;
      else if (e.size() == 2)
        first_two(value) += alpha * (first_two(e) - first_two(value));
      else
        value += alpha * (e - value);
      break;
    }
    case FeatureKind::log_nis_average:
      value[0] += memory.alpha * (innovation.nis - value[0]);
      break;
    case FeatureKind::log_mean_nis:
      value[0] += (innovation.nis - value[0]) / memory.used;
      break;
    case FeatureKind::log_interval: {  // the times of the last two
      const double before_s = value[0];
      value = Eigen::Vector2d(record.time_s, before_s);
      break;
    }
    case FeatureKind::frame_turn: {  // the velocities at the last two
      const Eigen::Vector2d now = level_velocity(record.x);
      const Eigen::Vector2d before = value.size() == 4 ? Eigen::Vector2d(value.head<2>()) : now;
      value.resize(4);
      value << now, before;
      break;
    }
    case FeatureKind::speed_change:
    case FeatureKind::velocity_change: {
      BoundedVector now = level_velocity(record.x);
      if (memory.kind != FeatureKind::velocity_change) now = BoundedVector::Constant(1, now.norm());
      const bool told = record.mode_probabilities && memory.mode < record.mode_probabilities->size();
      const double stays = told ? (*record.mode_probabilities)[memory.mode] : 0.0;
      if (memory.used == 1.0) value = now;
      value += memory.alpha * stays * (now - value);
      break;
    }
    default:
      break;  // remembers()
  }
}

const BoundedVector& FeatureExtractor::normalised_innovation(const StepRecord& record) {
  if (normalised_of_ != &record) {
    normalise(*record.innovation, frame_, normalised_);
    normalised_of_ = &record;
  }
  return normalised_;
}

double FeatureExtractor::value(const Term& term, const StepRecord& base, const StepRecord* companion) const {
  constexpr double kLeastSpeed_mps = 1e-3, kLeastTime_s = 1.0, kLeastInterval_s = 1e-3;
  const StepRecord& record = companion ? *companion : base;
  const int c = term.component;
  const Memory* const memory = memories_.data() + term.memory;
  const auto in_frame = [&](const BoundedVector& v) { return c < v.size() ? rotation_.component(v, c) : 0.0; };
  const auto own = [&] { return base.sensor.value_or(SensorState{}); };
  const auto scaled = [&](double value) { return value / (term.scale_is_sigma ? sigma_[c] : term.scale); };
  switch (term.kind) {
    case FeatureKind::log_step:
      return std::log(std::max(steps_, 1.0));
    case FeatureKind::gain: {
      if (c >= gain_.rows()) return 0.0;
      BoundedVector row(gain_.cols());
      for (Eigen::Index j = 0; j < gain_.cols(); ++j) row[j] = rotation_.component(gain_.col(j), c);
      return rotation_.component(row, c % gain_.cols());
    }
    case FeatureKind::residual:
    case FeatureKind::prediction_difference:
    case FeatureKind::innovation:
    case FeatureKind::innovation_average:
      break;  // is_remembered()
    case FeatureKind::log_nis_average:
    case FeatureKind::log_mean_nis:
      return std::log(term.offset + memory->value[0]);
    case FeatureKind::estimate:
      return scaled(in_frame(record.x));
    case FeatureKind::companion_difference:
      return scaled(in_frame(BoundedVector(record.x - base.x)));
    case FeatureKind::log_sigma:
      return std::log(companion ? std::sqrt(rotation_.variances(record.P)[c]) : sigma_[c]);
    case FeatureKind::log_speed:
      return std::log(std::max(level_velocity(record.x).norm(), kLeastSpeed_mps));
    case FeatureKind::aspect_cosine:
    case FeatureKind::aspect_sine: {
      const Eigen::Vector2d sight = base.x.head<2>() - own().position_m;
      const Eigen::Vector2d v = level_velocity(base.x);
      const double size = sight.norm() * v.norm();
      if (!(size > 0.0)) return 0.0;
      const double cross = v.x() * sight.y() - v.y() * sight.x();
      return (term.kind == FeatureKind::aspect_cosine ? v.dot(sight) : cross) / size;
    }
    case FeatureKind::mode_probability:
      if (!record.mode_probabilities || term.mode >= record.mode_probabilities->size()) return kNaN;
      return (*record.mode_probabilities)[term.mode];
    case FeatureKind::log_range:
      return log_range(record.x, own());
    case FeatureKind::log_first_range:
      return log_first_range_;
    case FeatureKind::log_time:
      return std::log(std::max(base.time_s - began_s_, kLeastTime_s));
    case FeatureKind::bearing_rate: {
      const Eigen::Vector2d d = record.x.head<2>() - own().position_m,
                            v = level_velocity(record.x) - own().velocity_mps;
      return (v.x() * d.y() - v.y() * d.x()) / std::max(d.squaredNorm(), kLeastRange_m * kLeastRange_m);
    }
    case FeatureKind::own_velocity:
      return rotation_.component(own().velocity_mps, c % (base.x.size() / 2)) / term.scale;
    case FeatureKind::speed_change:
      if (memory->used == 0.0) return 0.0;
      return std::log(std::max(level_velocity(record.x).norm(), kLeastSpeed_mps) /
                      std::max(memory->value[0], kLeastSpeed_mps));
    case FeatureKind::velocity_change:
      if (memory->used == 0.0) return 0.0;
      return rotation_.component(BoundedVector(level_velocity(record.x) - memory->value), c % (base.x.size() / 2)) /
             term.scale;
    case FeatureKind::neighbour_closeness:
      return base.neighbour ? base.neighbour->closeness : 0.0;
    case FeatureKind::neighbour_difference:
      return base.neighbour ? base.neighbour->closeness * scaled(in_frame(base.neighbour->difference)) : 0.0;
    case FeatureKind::sensor:
      return base.source == term.sensor ? 1.0 : 0.0;
    case FeatureKind::log_interval: {
      const bool uses = base.status == StepStatus::ok && base.innovation;
      const double last_s = memory->used > (uses ? 1.0 : 0.0) ? memory->value[uses ? 1 : 0] : began_s_;
      return std::log(std::max(base.time_s - last_s, kLeastInterval_s));
    }
    case FeatureKind::frame_turn: {
      if (memory->value.size() != 4) return 0.0;
      const bool uses = base.status == StepStatus::ok && base.innovation;
      const Eigen::Vector2d now = level_velocity(base.x),
                            then = uses ? memory->value.tail<2>() : memory->value.head<2>();
      return std::atan2(now.x() * then.y() - now.y() * then.x(), now.dot(then));
    }
  }
  return kNaN;
}

}  // namespace truebearing
