#include "truebearing/correction/feature_extractor.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>

#include "truebearing/core/error.hpp"
#include "truebearing/core/suggestion.hpp"

namespace truebearing {
namespace {

void check(const FeatureSpec& feature, const StateSpace& space, const FeatureExtractor::BlocksOf& blocks_of) {
  const FeatureNeeds needs = needs_of(feature.kind);
  const std::string where = fmt::format("feature {}", to_string(feature.kind));
  if (needs.component && space.component_index(feature.component) < 0)
    throw InputError(where, fmt::format("component \"{}\" is not in the state", feature.component),
                     suggestion(feature.component, space.components));
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
}

}  // namespace

FeatureExtractor::FeatureExtractor(std::vector<FeatureSpec> features, const StateSpace& space,
                                   const BlocksOf& blocks_of)
    : features_(std::move(features)) {
  if (features_.empty() || features_.size() > FuzzyNetwork::kMaxInputs)
    throw InputError("features", fmt::format("there are {}", features_.size()),
                     fmt::format("1 to {}", FuzzyNetwork::kMaxInputs));
  for (const FeatureSpec& feature : features_) {
    check(feature, space, blocks_of);
    int companion = -1;
    if (!feature.companion.empty()) {
      const auto known = std::find(companions_.begin(), companions_.end(), feature.companion);
      companion = static_cast<int>(known - companions_.begin());
      if (known == companions_.end()) companions_.push_back(feature.companion);
    }
    terms_.push_back({feature.kind, space.component_index(feature.component), companion, feature.alpha, feature.offset,
                      feature.scale});
  }
}

void FeatureExtractor::reset() {
  track_ = -1;
}

void FeatureExtractor::begin_track(int track) {
  track_ = track;
  steps_ = 0.0;
  for (Term& term : terms_) term.memory = term.used = 0.0;
}

void FeatureExtractor::extract(const StepRecord& base, std::span<const StepRecord* const> companions,
                               Features& features) {
  if (base.track != track_) begin_track(base.track);
  if (base.status == StepStatus::ok) steps_ += 1.0;
  features.resize(size());
  for (int i = 0; i < size(); ++i) {
    Term& term = terms_[static_cast<std::size_t>(i)];
    const StepRecord* companion = term.companion < 0 ? nullptr : companions[static_cast<std::size_t>(term.companion)];
    if (term.companion < 0)
      remember(term, base);
    else if (companion)
      remember(term, *companion);
    features[i] = value(term, base, companion, steps_);
  }
}

// Takes from a step in which the measurement was used what later steps want to know of it.
void FeatureExtractor::remember(Term& term, const StepRecord& record) {
  if (record.status != StepStatus::ok || !record.innovation) return;
  const Innovation& innovation = *record.innovation;
  double& memory = term.memory;
  term.used += 1.0;
  switch (term.kind) {
    case FeatureKind::gain:
      if (record.gain) memory = (*record.gain)(term.component, 0);
      break;
    case FeatureKind::residual:
      memory = innovation.z[0] - record.x[term.component];
      break;
    case FeatureKind::prediction_difference:
      if (record.prediction) memory = record.prediction->x[term.component] - record.x[term.component];
      break;
    case FeatureKind::innovation:
      memory = innovation.nu[0] / std::sqrt(innovation.S(0, 0));
      break;
    case FeatureKind::innovation_average:
      memory += term.alpha * (innovation.nu[0] / std::sqrt(innovation.S(0, 0)) - memory);
      break;
    case FeatureKind::log_nis_average:
      memory += term.alpha * (innovation.nis - memory);
      break;
    case FeatureKind::log_mean_nis:
      memory += (innovation.nis - memory) / term.used;
      break;
    case FeatureKind::log_step:
    case FeatureKind::estimate:
    case FeatureKind::companion_difference:
      break;
  }
}

double FeatureExtractor::value(const Term& term, const StepRecord& base, const StepRecord* companion, double steps) {
  if (term.companion >= 0 && !companion) return std::numeric_limits<double>::quiet_NaN();
  switch (term.kind) {
    case FeatureKind::log_step:
      return std::log(std::max(steps, 1.0));
    case FeatureKind::gain:
    case FeatureKind::residual:
    case FeatureKind::prediction_difference:
    case FeatureKind::innovation:
      return term.memory;
    case FeatureKind::innovation_average:
      return term.memory / std::sqrt(term.alpha / (2.0 - term.alpha));
    case FeatureKind::log_nis_average:
    case FeatureKind::log_mean_nis:
      return std::log(term.offset + term.memory);
    case FeatureKind::estimate: {
      const BoundedVector& x = companion ? companion->x : base.x;
      return x.size() == base.x.size() ? x[term.component] / term.scale : std::numeric_limits<double>::quiet_NaN();
    }
    case FeatureKind::companion_difference:
      if (companion->x.size() != base.x.size()) return std::numeric_limits<double>::quiet_NaN();
      return (companion->x[term.component] - base.x[term.component]) / term.scale;
  }
  return std::numeric_limits<double>::quiet_NaN();
}

}  // namespace truebearing
