// SPDX-License-Identifier: Apache-2.0
#include "truebearing/correction/feature_extractor.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

#include "truebearing/core/constants.hpp"
#include "truebearing/core/error.hpp"
#include "truebearing/core/suggestion.hpp"

namespace truebearing {
namespace {

// `space`: of the base's state; `components`: its components in the frame.
void check(const FeatureSpec& feature, const StateSpace& space, const StateSpace& components,
           const FeatureExtractor::BlocksOf& blocks_of) {
  const FeatureNeeds needs = needs_of(feature.kind);
  const std::string where = fmt::format("feature {}", to_string(feature.kind));
  const bool named = needs.component == FeatureNeeds::Component::required ||
                     (needs.component == FeatureNeeds::Component::optional && !feature.component.empty());
  const int component = components.component_index(feature.component);
  if (named && component < 0)
    throw InputError(where, fmt::format("component \"{}\" is not in the state", feature.component),
                     suggestion(feature.component, components.components));
  const bool measured = needs.component == FeatureNeeds::Component::optional || feature.kind == FeatureKind::residual;
  const int positions = space == lorenz_space() ? space.size() : components.size() / 2;
  if (measured && component >= positions && component > 0)
    throw InputError(where, fmt::format("component \"{}\" is not measured", feature.component), "a position");
  if (needs.velocity && component < components.size() / 2)
    throw InputError(where, fmt::format("component \"{}\" is no velocity", feature.component),
                     suggestion(feature.component,
                                {components.components.begin() + components.size() / 2, components.components.end()}));
  if (needs.plane && space != plane_space() && space != space_space())
    throw InputError(where, "has no meaning in the space " + space.name, "the space plane or space");
  if (needs.plane && named && feature.component == "up_mps")
    throw InputError(where, "is of the level velocity, and its component is \"up_mps\"", "along or across");
  if (needs.mode && (feature.mode < 1 || feature.mode > kMaxModes))
    throw InputError(where, fmt::format("mode is {}", feature.mode), fmt::format("1 to {}", kMaxModes));
  if (needs.sensor && feature.sensor < 1)
    throw InputError(where, fmt::format("sensor is {}", feature.sensor), "its place among the sensors' names, from 1");
  if (needs.companion == FeatureNeeds::Companion::required && feature.companion.empty())
    throw InputError(where, "names no companion");
  if (needs.alpha && !(feature.alpha > 0.0 && feature.alpha <= 1.0))
    throw InputError(where, fmt::format("alpha is {}", feature.alpha), "a number in (0, 1]");
  if (needs.offset && !(feature.offset > 0.0 && std::isfinite(feature.offset)))
    throw InputError(where, fmt::format("offset is {}", feature.offset), "a number > 0");
  if (needs.scale && !(feature.scale > 0.0 && std::isfinite(feature.scale)))
    throw InputError(where, fmt::format("scale is {}", feature.scale), "a number > 0");
  const auto missing = [&](const char* block) {
    const std::string tracker = feature.companion.empty() ? "the base tracker" : feature.companion;
    return InputError(where, fmt::format("needs the {} in the records of {}, which carry none", block, tracker));
  };
  const RecordBlocks blocks = blocks_of(feature.companion);
  if (needs.blocks.prediction && !blocks.prediction) throw missing("prediction");
  if (needs.blocks.innovation && !blocks.innovation) throw missing("innovation");
  if (needs.blocks.gain && !blocks.gain) throw missing("gain");
  if (measured && &space != &components && !blocks.measures_position)
    throw InputError(where, "has no direction: what is measured is not a position", "a tracker of positions");
  if (needs.blocks.mode_probabilities && !blocks.mode_probabilities) throw missing("mode probabilities");
  if (needs.blocks.neighbour && !blocks.neighbour) throw missing("neighbour");
}

// e of an innovation: each component over its own standard deviation. In a frame that turns with the target it must not
// matter which way the axes of the plane point, so that there e = S^-1/2 nu with the symmetric root, which turns as nu
// does; where the components are not correlated the two are the same. Up, which does not turn, is by itself.
BoundedVector normalised(const Innovation& innovation, Frame frame) {
  const BoundedMatrix& S = innovation.S;
  BoundedVector e = innovation.nu.cwiseQuotient(S.diagonal().cwiseSqrt());
  if (frame == Frame::state || S.rows() < 2 || S.rows() > 3 || S(0, 1) == 0.0) return e;
  // S^1/2 = (S + s I) / t with s = sqrt(det S), t = sqrt(tr S + 2 s).
  const double s = std::sqrt(std::max(S(0, 0) * S(1, 1) - S(0, 1) * S(1, 0), 0.0));
  const double t = std::sqrt(S(0, 0) + S(1, 1) + 2.0 * s);
  const double a = S(0, 0) + s, b = S(0, 1), c = S(1, 1) + s, scale = t / (a * c - b * b);
  e.head<2>() << scale * (c * innovation.nu[0] - b * innovation.nu[1]),
      scale * (a * innovation.nu[1] - b * innovation.nu[0]);
  return e;
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
  for (const FeatureSpec& feature : features_) {
    check(feature, space, components, blocks_of);
    int companion = -1;
    if (!feature.companion.empty()) {
      const auto known = std::find(companions_.begin(), companions_.end(), feature.companion);
      companion = static_cast<int>(known - companions_.begin());
      if (known == companions_.end()) companions_.push_back(feature.companion);
    }
    wants_sigma_ |= feature.scale_is_sigma || feature.kind == FeatureKind::log_sigma;
    terms_.push_back({feature.kind, std::max(components.component_index(feature.component), 0), companion,
                      feature.alpha, feature.offset, feature.scale, feature.scale_is_sigma, feature.mode - 1,
                      feature.sensor - 1});
  }
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
  for (Term& term : terms_) {
    term.memory = BoundedVector::Zero(1);
    term.used = 0.0;
  }
}

void FeatureExtractor::extract(const StepRecord& base, std::span<const StepRecord* const> companions,
                               Features& features) {
  if (base.track != track_) begin_track(base);
  interval_memory_.take(base);
  if (base.status == StepStatus::ok) steps_ += 1.0;
  if (base.status == StepStatus::ok && base.gain) gain_ = *base.gain;
  rotation_ = FrameRotation(frame_, base.x, base.sensor);
  if (wants_sigma_) sigma_ = rotation_.covariance(base.P).diagonal().cwiseSqrt();
  features.resize(size());
  normalised_of_ = nullptr;
  for (int i = 0; i < size(); ++i) {
    Term& term = terms_[static_cast<std::size_t>(i)];
    const StepRecord* companion = term.companion < 0 ? nullptr : companions[static_cast<std::size_t>(term.companion)];
    if (term.companion < 0)
      remember(term, base);
    else if (companion)
      remember(term, *companion);
    features[i] = value(term, base, companion);
  }
}

// Takes from a step in which the measurement was used what later steps want to know of it.
void FeatureExtractor::remember(Term& term, const StepRecord& record) {
  if (record.status != StepStatus::ok || !record.innovation) return;
  const Innovation& innovation = *record.innovation;
  BoundedVector& memory = term.memory;
  term.used += 1.0;
  switch (term.kind) {
    case FeatureKind::residual:
      memory = innovation.z - record.x.head(innovation.z.size());
      break;
    case FeatureKind::prediction_difference:
      if (record.prediction) memory = record.prediction->x - record.x;
      break;
    case FeatureKind::innovation:
    case FeatureKind::innovation_average: {
      const double alpha = term.kind == FeatureKind::innovation ? 1.0 : term.alpha;
      const BoundedVector& e = normalised_innovation(record);
      if (memory.size() != e.size()) memory = BoundedVector::Zero(e.size());
      for (Eigen::Index i = 0; i < memory.size(); ++i)
        memory[i] = alpha == 1.0 ? e[i] : memory[i] + alpha * (e[i] - memory[i]);
      break;
    }
    case FeatureKind::log_nis_average:
      memory[0] += term.alpha * (innovation.nis - memory[0]);
      break;
    case FeatureKind::log_mean_nis:
      memory[0] += (innovation.nis - memory[0]) / term.used;
      break;
    case FeatureKind::log_interval: {  // the times of the last two
      const double before_s = memory[0];
      memory = Eigen::Vector2d(record.time_s, before_s);
      break;
    }
    case FeatureKind::frame_turn: {  // the velocities at the last two
      const Eigen::Vector2d now = level_velocity(record.x);
      const Eigen::Vector2d before = memory.size() == 4 ? Eigen::Vector2d(memory.head<2>()) : now;
      memory.resize(4);
      memory << now, before;
      break;
    }
    case FeatureKind::speed_change:
    case FeatureKind::velocity_change: {
      BoundedVector now = level_velocity(record.x);
      if (term.kind != FeatureKind::velocity_change) now = BoundedVector::Constant(1, now.norm());
      const bool told = record.mode_probabilities && term.mode < record.mode_probabilities->size();
      const double stays = told ? (*record.mode_probabilities)[term.mode] : 0.0;
      if (term.used == 1.0) memory = now;
      memory += term.alpha * stays * (now - memory);
      break;
    }
    case FeatureKind::log_step:
    case FeatureKind::gain:
    case FeatureKind::estimate:
    case FeatureKind::companion_difference:
    case FeatureKind::log_sigma:
    case FeatureKind::log_speed:
    case FeatureKind::aspect_cosine:
    case FeatureKind::aspect_sine:
    case FeatureKind::mode_probability:
    case FeatureKind::log_range:
    case FeatureKind::log_first_range:
    case FeatureKind::log_time:
    case FeatureKind::bearing_rate:
    case FeatureKind::own_velocity:
    case FeatureKind::neighbour_closeness:
    case FeatureKind::neighbour_difference:
    case FeatureKind::sensor:
      break;
  }
}

const BoundedVector& FeatureExtractor::normalised_innovation(const StepRecord& record) {
  if (normalised_of_ != &record) {
    normalised_ = normalised(*record.innovation, frame_);
    normalised_of_ = &record;
  }
  return normalised_;
}

double FeatureExtractor::value(const Term& term, const StepRecord& base, const StepRecord* companion) const {
  constexpr double kLeastSpeed_mps = 1e-3, kLeastTime_s = 1.0, kLeastInterval_s = 1e-3;
  if (term.companion >= 0 && !companion) return kNaN;
  const StepRecord& record = companion ? *companion : base;
  if (record.x.size() != base.x.size()) return kNaN;
  const int c = term.component;
  // A component of a vector of the state's own frame, in the frame; before the first used measurement it is zero.
  const auto in_frame = [&](const BoundedVector& v) {
    if (rotation_.rotates() && v.size() < 2) return 0.0;
    return c < v.size() ? rotation_.component(v, c) : 0.0;
  };
  const SensorState own = base.sensor.value_or(SensorState{});
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
      return in_frame(term.memory);
    case FeatureKind::innovation_average:
      return in_frame(term.memory) / std::sqrt(term.alpha / (2.0 - term.alpha));
    case FeatureKind::log_nis_average:
    case FeatureKind::log_mean_nis:
      return std::log(term.offset + term.memory[0]);
    case FeatureKind::estimate:
      return scaled(in_frame(record.x));
    case FeatureKind::companion_difference:
      return scaled(in_frame(BoundedVector(record.x - base.x)));
    case FeatureKind::log_sigma:
      return std::log(companion ? std::sqrt(rotation_.covariance(record.P)(c, c)) : sigma_[c]);
    case FeatureKind::log_speed:
      return std::log(std::max(level_velocity(record.x).norm(), kLeastSpeed_mps));
    case FeatureKind::aspect_cosine:
    case FeatureKind::aspect_sine: {
      const Eigen::Vector2d sight = base.x.head<2>() - own.position_m;
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
      return log_range(record.x, own);
    case FeatureKind::log_first_range:
      return log_first_range_;
    case FeatureKind::log_time:
      return std::log(std::max(base.time_s - began_s_, kLeastTime_s));
    case FeatureKind::bearing_rate: {
      const Eigen::Vector2d d = record.x.head<2>() - own.position_m, v = level_velocity(record.x) - own.velocity_mps;
      return (v.x() * d.y() - v.y() * d.x()) / std::max(d.squaredNorm(), kLeastRange_m * kLeastRange_m);
    }
    case FeatureKind::own_velocity:
      return rotation_.component(own.velocity_mps, c % (base.x.size() / 2)) / term.scale;
    case FeatureKind::speed_change:
      if (term.used == 0.0) return 0.0;
      return std::log(std::max(level_velocity(record.x).norm(), kLeastSpeed_mps) /
                      std::max(term.memory[0], kLeastSpeed_mps));
    case FeatureKind::velocity_change:
      if (term.used == 0.0) return 0.0;
      return rotation_.component(BoundedVector(level_velocity(record.x) - term.memory), c % (base.x.size() / 2)) /
             term.scale;
    case FeatureKind::neighbour_closeness:
      return base.neighbour ? base.neighbour->closeness : 0.0;
    case FeatureKind::neighbour_difference:
      return base.neighbour ? base.neighbour->closeness * scaled(in_frame(base.neighbour->difference)) : 0.0;
    case FeatureKind::sensor:
      return base.source == term.sensor ? 1.0 : 0.0;
    case FeatureKind::log_interval: {
      const bool uses = base.status == StepStatus::ok && base.innovation;
      const double last_s = term.used > (uses ? 1.0 : 0.0) ? term.memory[uses ? 1 : 0] : began_s_;
      return std::log(std::max(base.time_s - last_s, kLeastInterval_s));
    }
    case FeatureKind::frame_turn: {
      if (term.memory.size() != 4) return 0.0;
      const bool uses = base.status == StepStatus::ok && base.innovation;
      const Eigen::Vector2d now = level_velocity(base.x), then = uses ? term.memory.tail<2>() : term.memory.head<2>();
      return std::atan2(now.x() * then.y() - now.y() * then.x(), now.dot(then));
    }
  }
  return kNaN;
}

}  // namespace truebearing
