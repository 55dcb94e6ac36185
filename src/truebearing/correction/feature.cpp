#include "truebearing/correction/feature.hpp"

#include <algorithm>
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
constexpr RecordBlocks kModes{.mode_probabilities = true};
constexpr RecordBlocks kNeighbour{.neighbour = true};

/// How a feature answers to a mirrored target.
enum class Mirror {
  even,         ///< stays
  odd,          ///< changes sign
  by_component  ///< as its component does
};

struct Kind {
  FeatureKind kind;
  const char* name;
  Mirror mirror;
  FeatureNeeds needs;
};

constexpr auto kOptional = FeatureNeeds::Companion::optional;
constexpr auto kRequired = FeatureNeeds::Companion::required;
constexpr auto kComponent = FeatureNeeds::Component::required;
constexpr auto kAxis = FeatureNeeds::Component::optional;

// One line per kind: everything the house knows of it besides its formula, which is in feature_extractor.cpp.
constexpr std::array<Kind, 24> kKinds{{
    {FeatureKind::log_step, "log_step", Mirror::even, {.blocks = kNothing}},
    {FeatureKind::gain, "gain", Mirror::even, {.component = kComponent, .blocks = kGain}},
    {FeatureKind::residual, "residual", Mirror::by_component, {.component = kComponent, .blocks = kInnovation}},
    {FeatureKind::prediction_difference,
     "prediction_difference",
     Mirror::by_component,
     {.component = kComponent, .blocks = kPrediction}},
    {FeatureKind::innovation,
     "innovation",
     Mirror::by_component,
     {.component = kAxis, .companion = kOptional, .blocks = kInnovation}},
    {FeatureKind::innovation_average,
     "innovation_average",
     Mirror::by_component,
     {.component = kAxis, .companion = kOptional, .alpha = true, .blocks = kInnovation}},
    {FeatureKind::log_nis_average,
     "log_nis_average",
     Mirror::even,
     {.companion = kOptional, .alpha = true, .offset = true, .blocks = kInnovation}},
    {FeatureKind::log_mean_nis,
     "log_mean_nis",
     Mirror::even,
     {.companion = kOptional, .offset = true, .blocks = kInnovation}},
    {FeatureKind::estimate,
     "estimate",
     Mirror::by_component,
     {.component = kComponent, .companion = kOptional, .scale = true, .blocks = kNothing}},
    {FeatureKind::companion_difference,
     "companion_difference",
     Mirror::by_component,
     {.component = kComponent, .companion = kRequired, .scale = true, .blocks = kNothing}},
    {FeatureKind::log_sigma,
     "log_sigma",
     Mirror::even,
     {.component = kComponent, .companion = kOptional, .blocks = kNothing}},
    {FeatureKind::log_speed, "log_speed", Mirror::even, {.companion = kOptional, .plane = true, .blocks = kNothing}},
    {FeatureKind::aspect_cosine, "aspect_cosine", Mirror::even, {.plane = true, .blocks = kNothing}},
    {FeatureKind::aspect_sine, "aspect_sine", Mirror::odd, {.plane = true, .blocks = kNothing}},
    {FeatureKind::mode_probability,
     "mode_probability",
     Mirror::even,
     {.companion = kOptional, .mode = true, .blocks = kModes}},
    {FeatureKind::log_range, "log_range", Mirror::even, {.companion = kOptional, .plane = true, .blocks = kNothing}},
    {FeatureKind::log_first_range, "log_first_range", Mirror::even, {.plane = true, .blocks = kNothing}},
    {FeatureKind::log_time, "log_time", Mirror::even, {.blocks = kNothing}},
    {FeatureKind::bearing_rate,
     "bearing_rate",
     Mirror::odd,
     {.companion = kOptional, .plane = true, .blocks = kNothing}},
    {FeatureKind::own_velocity,
     "own_velocity",
     Mirror::by_component,
     {.component = kComponent, .velocity = true, .scale = true, .plane = true, .blocks = kNothing}},
    {FeatureKind::speed_change,
     "speed_change",
     Mirror::even,
     {.companion = kOptional, .alpha = true, .mode = true, .plane = true, .blocks = kModes}},
    {FeatureKind::velocity_change,
     "velocity_change",
     Mirror::by_component,
     {.component = kComponent,
      .companion = kOptional,
      .velocity = true,
      .alpha = true,
      .scale = true,
      .mode = true,
      .plane = true,
      .blocks = kModes}},
    {FeatureKind::neighbour_closeness, "neighbour_closeness", Mirror::even, {.blocks = kNeighbour}},
    {FeatureKind::neighbour_difference,
     "neighbour_difference",
     Mirror::by_component,
     {.component = kComponent, .scale = true, .blocks = kNeighbour}},
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

int mirror_parity(const FeatureSpec& feature, Frame frame, const StateSpace& space) {
  switch (entry(feature.kind).mirror) {
    case Mirror::even:
      return +1;
    case Mirror::odd:
      return -1;
    case Mirror::by_component:
      break;
  }
  return component_parity(frame, std::max(space_in(frame, space).component_index(feature.component), 0));
}

std::string describe(const FeatureSpec& feature) {
  const std::string of = feature.companion.empty() ? "" : " of " + feature.companion;
  const std::string in = feature.component.empty() ? "" : " in " + feature.component;
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
      return "innovation" + of + in;
    case FeatureKind::innovation_average:
      return fmt::format("innovation average {}{}{}", feature.alpha, of, in);
    case FeatureKind::log_nis_average:
      return fmt::format("ln NIS average {}{}", feature.alpha, of);
    case FeatureKind::log_mean_nis:
      return "ln mean NIS" + of;
    case FeatureKind::estimate:
      return fmt::format("estimate{} in {}", of, feature.component);
    case FeatureKind::companion_difference:
      return fmt::format("difference{} in {}", of, feature.component);
    case FeatureKind::log_sigma:
      return fmt::format("ln sigma{} in {}", of, feature.component);
    case FeatureKind::log_speed:
      return "ln speed" + of;
    case FeatureKind::aspect_cosine:
      return "cosine of the aspect";
    case FeatureKind::aspect_sine:
      return "sine of the aspect";
    case FeatureKind::mode_probability:
      return fmt::format("probability of mode {}{}", feature.mode, of);
    case FeatureKind::log_range:
      return "ln range" + of;
    case FeatureKind::log_first_range:
      return "ln first range";
    case FeatureKind::log_time:
      return "ln time";
    case FeatureKind::bearing_rate:
      return "bearing rate" + of;
    case FeatureKind::own_velocity:
      return "own velocity in " + feature.component;
    case FeatureKind::speed_change:
      return fmt::format("ln speed{} against that in mode {}, average {}", of, feature.mode, feature.alpha);
    case FeatureKind::velocity_change:
      return fmt::format("change{} in {} against mode {}, average {}", of, feature.component, feature.mode,
                         feature.alpha);
    case FeatureKind::neighbour_closeness:
      return "closeness of the neighbour";
    case FeatureKind::neighbour_difference:
      return "difference of the neighbour in " + feature.component;
  }
  return {};
}

}  // namespace truebearing
