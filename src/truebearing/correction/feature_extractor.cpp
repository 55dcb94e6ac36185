#include "truebearing/correction/feature_extractor.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>

#include "truebearing/core/error.hpp"
#include "truebearing/core/suggestion.hpp"

namespace truebearing {
namespace {

void check(const FeatureSpec& feature, const StateSpace& space, RecordBlocks blocks) {
  const FeatureNeeds needs = needs_of(feature.kind);
  const std::string where = fmt::format("feature {}", to_string(feature.kind));
  if (needs.component && space.component_index(feature.component) < 0)
    throw InputError(where, fmt::format("component \"{}\" is not in the state", feature.component),
                     suggestion(feature.component, space.components));
  if (needs.companion && feature.companion.empty()) throw InputError(where, "names no companion");
  if (needs.alpha && !(feature.alpha > 0.0 && feature.alpha <= 1.0))
    throw InputError(where, fmt::format("alpha is {}", feature.alpha), "a number in (0, 1]");
  if (needs.offset && !(feature.offset > 0.0 && std::isfinite(feature.offset)))
    throw InputError(where, fmt::format("offset is {}", feature.offset), "a number > 0");
  if (needs.scale && !(feature.scale > 0.0 && std::isfinite(feature.scale)))
    throw InputError(where, fmt::format("scale is {}", feature.scale), "a number > 0");
  const auto missing = [&](const char* block) {
    return InputError(where, fmt::format("needs the {} of the base tracker's records, which carry none", block));
  };
  if (needs.blocks.prediction && !blocks.prediction) throw missing("prediction");
  if (needs.blocks.innovation && !blocks.innovation) throw missing("innovation");
  if (needs.blocks.gain && !blocks.gain) throw missing("gain");
}

}  // namespace

FeatureExtractor::FeatureExtractor(std::vector<FeatureSpec> features, const StateSpace& space, RecordBlocks base_blocks)
    : features_(std::move(features)) {
  if (features_.empty() || features_.size() > FuzzyNetwork::kMaxInputs)
    throw InputError("features", fmt::format("there are {}", features_.size()),
                     fmt::format("1 to {}", FuzzyNetwork::kMaxInputs));
  for (const FeatureSpec& feature : features_) {
    check(feature, space, base_blocks);
    int companion = -1;
    if (needs_of(feature.kind).companion) {
      const auto known = std::find(companions_.begin(), companions_.end(), feature.companion);
      companion = static_cast<int>(known - companions_.begin());
      if (known == companions_.end()) companions_.push_back(feature.companion);
    }
    terms_.push_back({feature.kind, space.component_index(feature.component), companion, feature.alpha, feature.offset,
                      feature.scale, 0.0});
  }
}

void FeatureExtractor::reset() { track_ = -1; }

void FeatureExtractor::begin_track(int track) {
  track_ = track;
  steps_ = used_ = nis_sum_ = 0.0;
  for (Term& term : terms_) term.memory = 0.0;
}

void FeatureExtractor::extract(const StepRecord& base, std::span<const StepRecord* const> companions, Features& features) {
  if (base.track != track_) begin_track(base.track);
  steps_ += 1.0;
  if (base.status == StepStatus::ok && base.innovation) {
    used_ += 1.0;
    nis_sum_ += base.innovation->nis;
  }
  const double mean_nis = used_ > 0.0 ? nis_sum_ / used_ : 0.0;
  features.resize(size());
  for (int i = 0; i < size(); ++i)
    features[i] = value(terms_[static_cast<std::size_t>(i)], base, companions, steps_, mean_nis);
}

double FeatureExtractor::value(Term& term, const StepRecord& base, std::span<const StepRecord* const> companions,
                               double steps, double mean_nis) {
  const bool used = base.status == StepStatus::ok && base.innovation;
  double& memory = term.memory;
  switch (term.kind) {
    case FeatureKind::log_step: return std::log(steps);
    case FeatureKind::gain:
      if (used && base.gain) memory = (*base.gain)(term.component, 0);
      return memory;
    case FeatureKind::residual:
      if (used) memory = base.innovation->z[0] - base.x[term.component];
      return memory;
    case FeatureKind::prediction_difference:
      if (used && base.prediction) memory = base.prediction->x[term.component] - base.x[term.component];
      return memory;
    case FeatureKind::innovation:
      if (used) memory = base.innovation->nu[0] / std::sqrt(base.innovation->S(0, 0));
      return memory;
    case FeatureKind::innovation_average:
      if (used)
        memory += term.alpha * (base.innovation->nu[0] / std::sqrt(base.innovation->S(0, 0)) - memory);
      return memory / std::sqrt(term.alpha / (2.0 - term.alpha));
    case FeatureKind::log_nis_average:
      if (used) memory += term.alpha * (base.innovation->nis - memory);
      return std::log(term.offset + memory);
    case FeatureKind::log_mean_nis: return std::log(term.offset + mean_nis);
    case FeatureKind::companion_difference: {
      const StepRecord* companion = companions[static_cast<std::size_t>(term.companion)];
      if (!companion || companion->x.size() != base.x.size()) return std::numeric_limits<double>::quiet_NaN();
      return (companion->x[term.component] - base.x[term.component]) / term.scale;
    }
  }
  return std::numeric_limits<double>::quiet_NaN();
}

}  // namespace truebearing
