#include "truebearing/correction/feature.hpp"

#include <array>
#include <fmt/format.h>

#include "truebearing/core/error.hpp"
#include "truebearing/core/suggestion.hpp"

namespace truebearing {
namespace {

constexpr RecordBlocks kNothing{};
constexpr RecordBlocks kPrediction{.prediction = true};
constexpr RecordBlocks kInnovation{.innovation = true};
constexpr RecordBlocks kGain{.gain = true};

struct Kind {
  FeatureKind kind;
  const char* name;
  int parity;
  FeatureNeeds needs;
};

// One line per kind: everything the house knows of it besides its formula, which is in feature_extractor.cpp.
constexpr auto kOptional = FeatureNeeds::Companion::optional;
constexpr auto kRequired = FeatureNeeds::Companion::required;

// One line per kind: everything the house knows of it besides its formula, which is in feature_extractor.cpp.
constexpr std::array<Kind, 10> kKinds{{
    {FeatureKind::log_step, "log_step", +1, {.blocks = kNothing}},
    {FeatureKind::gain, "gain", +1, {.component = true, .blocks = kGain}},
    {FeatureKind::residual, "residual", -1, {.component = true, .blocks = kInnovation}},
    {FeatureKind::prediction_difference, "prediction_difference", -1, {.component = true, .blocks = kPrediction}},
    {FeatureKind::innovation, "innovation", -1, {.companion = kOptional, .blocks = kInnovation}},
    {FeatureKind::innovation_average,
     "innovation_average",
     -1,
     {.companion = kOptional, .alpha = true, .blocks = kInnovation}},
    {FeatureKind::log_nis_average,
     "log_nis_average",
     +1,
     {.companion = kOptional, .alpha = true, .offset = true, .blocks = kInnovation}},
    {FeatureKind::log_mean_nis, "log_mean_nis", +1, {.companion = kOptional, .offset = true, .blocks = kInnovation}},
    {FeatureKind::estimate,
     "estimate",
     -1,
     {.component = true, .companion = kOptional, .scale = true, .blocks = kNothing}},
    {FeatureKind::companion_difference,
     "companion_difference",
     -1,
     {.component = true, .companion = kRequired, .scale = true, .blocks = kNothing}},
}};

const Kind& entry(FeatureKind kind) {
  return kKinds[static_cast<std::size_t>(kind)];
}

}  // namespace

std::string_view to_string(FeatureKind kind) {
  return entry(kind).name;
}

const std::vector<std::string>& feature_kind_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> list;
    for (const Kind& kind : kKinds) list.emplace_back(kind.name);
    return list;
  }();
  return names;
}

FeatureKind feature_kind(const std::string& name) {
  for (const Kind& kind : kKinds)
    if (name == kind.name) return kind.kind;
  throw InputError("feature", "\"" + name + "\" is not known", suggestion(name, feature_kind_names()));
}

FeatureNeeds needs_of(FeatureKind kind) {
  return entry(kind).needs;
}

int mirror_parity(FeatureKind kind) {
  return entry(kind).parity;
}

std::string describe(const FeatureSpec& feature) {
  const std::string of = feature.companion.empty() ? "" : " of " + feature.companion;
  switch (feature.kind) {
    case FeatureKind::log_step:
      return "ln step";
    case FeatureKind::gain:
      return "gain in " + feature.component;
    case FeatureKind::residual:
      return "residual in " + feature.component;
    case FeatureKind::prediction_difference:
      return "prediction difference in " + feature.component;
    case FeatureKind::innovation:
      return "innovation" + of;
    case FeatureKind::innovation_average:
      return fmt::format("innovation average {}{}", feature.alpha, of);
    case FeatureKind::log_nis_average:
      return fmt::format("ln NIS average {}{}", feature.alpha, of);
    case FeatureKind::log_mean_nis:
      return "ln mean NIS" + of;
    case FeatureKind::estimate:
      return fmt::format("estimate{} in {}", of, feature.component);
    case FeatureKind::companion_difference:
      return fmt::format("difference{} in {}", of, feature.component);
  }
  return {};
}

}  // namespace truebearing
