// SPDX-License-Identifier: Apache-2.0
// The kinds of features: their names, what each needs, how it reads. Their formulas are in feature_extractor.cpp; a new
// kind is a name here, a row of the table below, and a formula there.
#pragma once

#include <array>

#include "truebearing/tracker/tracker.hpp"

namespace truebearing {

// What is said to be of the plane is in space of the level part: range, speed and direction along the ground.
enum class FeatureKind {
  log_step,  ///< ln k, k the number of steps of this track in which the base used its measurement, 1 before the first
  gain,      ///< the gain of a component on the measured component that it belongs to: K[component, 0] on a line
  residual,  ///< z - x[component], after the update
  prediction_difference,  ///< x_pred[component] - x[component]
  innovation,             ///< e_i = nu_i / sqrt(S_ii), the normalised innovation; in a frame that turns with the target
                          ///< e = S^-1/2 nu
  innovation_average,     ///< a <- (1 - alpha) a + alpha e, divided by sqrt(alpha / (2 - alpha)), its deviation if e is
                          ///< white
  log_nis_average,        ///< ln(offset + a), a <- (1 - alpha) a + alpha NIS
  log_mean_nis,           ///< ln(offset + mean of the NIS of this track so far)
  estimate,               ///< x[component] / scale
  companion_difference,   ///< (x_companion[component] - x[component]) / scale
  log_sigma,              ///< ln sqrt(P[component, component])
  log_speed,              ///< ln of the speed, at least 1e-3 m/s; plane space
  aspect_cosine,          ///< of the angle from the line of sight to the velocity; plane space
  aspect_sine,            ///< positive where the target crosses to starboard of the line of sight
  mode_probability,       ///< mu[mode] of a multiple-model tracker
  log_range,              ///< ln of the distance from the sensor, at least 1 m; plane space
  log_first_range,  ///< ln of the distance with which the track began, at least 1 m: what was believed; plane space
  log_time,         ///< ln of the time since the track began, at least 1 s
  bearing_rate,     ///< d bearing/dt of the estimate as the sensor sees it from its own course, rad/s; plane space
  own_velocity,     ///< the sensor's velocity[component] / scale; plane space
  speed_change,  ///< ln(speed / m), m <- m + alpha mu[mode] (speed - m): against the speed before the target left that
                 ///< mode; plane space
  velocity_change,  ///< (v - m)[component] / scale, m <- m + alpha mu[mode] (v - m): against the velocity before; plane
                    ///< space
  neighbour_closeness,   ///< how near the nearest other target is, in (0, 1]; 0 where the tracker follows no other
  neighbour_difference,  ///< closeness (x_neighbour[component] - x[component]) / scale; 0 where there is no other
  log_interval,          ///< ln of the time from the last used measurement before this step to this step, at least 1 ms
  sensor,                ///< 1 where that one of several sensors took the step's measurement, else 0
  frame_turn  ///< the angle by which the velocity has turned since the last used measurement, to starboard, rad; plane
              ///< space
};

/// What a feature of this kind reads beside the state.
struct FeatureNeeds {
  enum class Companion { none, optional, required };

  enum class Component { none, optional, required };

  Component component = Component::none;
  Companion companion = Companion::none;
  bool velocity = false;  ///< the component is one of a velocity
  bool alpha = false;
  bool offset = false;
  bool scale = false;
  bool mode = false;
  bool sensor = false;
  bool plane = false;   ///< has a meaning in the plane space only
  RecordBlocks blocks;  ///< of the companion's records where one is named, else of the base's
};

namespace detail {

inline constexpr RecordBlocks kNothing{};
inline constexpr RecordBlocks kPrediction{.prediction = true};
inline constexpr RecordBlocks kInnovation{.innovation = true};
inline constexpr RecordBlocks kGain{.gain = true};
inline constexpr RecordBlocks kModes{.mode_probabilities = true};
inline constexpr RecordBlocks kNeighbour{.neighbour = true};

/// How a feature answers to a mirrored target.
enum class FeatureMirror {
  even,         ///< stays
  odd,          ///< changes sign
  by_component  ///< as its component does
};

struct FeatureRow {
  FeatureKind kind;
  const char* name;  ///< as studies and model files spell it
  const char*
      words;  ///< for tables and sentences: {component}, {alpha}, {mode}, {sensor}, {of} a companion, {in} a component
  FeatureMirror mirror;
  FeatureNeeds needs;
};

inline constexpr auto kOptional = FeatureNeeds::Companion::optional;
inline constexpr auto kRequired = FeatureNeeds::Companion::required;
inline constexpr auto kComponent = FeatureNeeds::Component::required;
inline constexpr auto kAxis = FeatureNeeds::Component::optional;

/// One row per kind, in the order of the enumeration: everything the house knows of it besides its formula.
inline constexpr std::array kFeatureRows{
    FeatureRow{FeatureKind::log_step, "log_step", "ln step", FeatureMirror::even, {.blocks = kNothing}},
    FeatureRow{FeatureKind::gain,
               "gain",
               "gain in {component}",
               FeatureMirror::even,
               {.component = kComponent, .blocks = kGain}},
    FeatureRow{FeatureKind::residual,
               "residual",
               "residual in {component}",
               FeatureMirror::by_component,
               {.component = kComponent, .blocks = kInnovation}},
    FeatureRow{FeatureKind::prediction_difference,
               "prediction_difference",
               "prediction difference in {component}",
               FeatureMirror::by_component,
               {.component = kComponent, .blocks = kPrediction}},
    FeatureRow{FeatureKind::innovation,
               "innovation",
               "innovation{of}{in}",
               FeatureMirror::by_component,
               {.component = kAxis, .companion = kOptional, .blocks = kInnovation}},
    FeatureRow{FeatureKind::innovation_average,
               "innovation_average",
               "innovation average {alpha}{of}{in}",
               FeatureMirror::by_component,
               {.component = kAxis, .companion = kOptional, .alpha = true, .blocks = kInnovation}},
    FeatureRow{FeatureKind::log_nis_average,
               "log_nis_average",
               "ln NIS average {alpha}{of}",
               FeatureMirror::even,
               {.companion = kOptional, .alpha = true, .offset = true, .blocks = kInnovation}},
    FeatureRow{FeatureKind::log_mean_nis,
               "log_mean_nis",
               "ln mean NIS{of}",
               FeatureMirror::even,
               {.companion = kOptional, .offset = true, .blocks = kInnovation}},
    FeatureRow{FeatureKind::estimate,
               "estimate",
               "estimate{of} in {component}",
               FeatureMirror::by_component,
               {.component = kComponent, .companion = kOptional, .scale = true, .blocks = kNothing}},
    FeatureRow{FeatureKind::companion_difference,
               "companion_difference",
               "difference{of} in {component}",
               FeatureMirror::by_component,
               {.component = kComponent, .companion = kRequired, .scale = true, .blocks = kNothing}},
    FeatureRow{FeatureKind::log_sigma,
               "log_sigma",
               "ln sigma{of} in {component}",
               FeatureMirror::even,
               {.component = kComponent, .companion = kOptional, .blocks = kNothing}},
    FeatureRow{FeatureKind::log_speed,
               "log_speed",
               "ln speed{of}",
               FeatureMirror::even,
               {.companion = kOptional, .plane = true, .blocks = kNothing}},
    FeatureRow{FeatureKind::aspect_cosine,
               "aspect_cosine",
               "cosine of the aspect",
               FeatureMirror::even,
               {.plane = true, .blocks = kNothing}},
    FeatureRow{FeatureKind::aspect_sine,
               "aspect_sine",
               "sine of the aspect",
               FeatureMirror::odd,
               {.plane = true, .blocks = kNothing}},
    FeatureRow{FeatureKind::mode_probability,
               "mode_probability",
               "probability of mode {mode}{of}",
               FeatureMirror::even,
               {.companion = kOptional, .mode = true, .blocks = kModes}},
    FeatureRow{FeatureKind::log_range,
               "log_range",
               "ln range{of}",
               FeatureMirror::even,
               {.companion = kOptional, .plane = true, .blocks = kNothing}},
    FeatureRow{FeatureKind::log_first_range,
               "log_first_range",
               "ln first range",
               FeatureMirror::even,
               {.plane = true, .blocks = kNothing}},
    FeatureRow{FeatureKind::log_time, "log_time", "ln time", FeatureMirror::even, {.blocks = kNothing}},
    FeatureRow{FeatureKind::bearing_rate,
               "bearing_rate",
               "bearing rate{of}",
               FeatureMirror::odd,
               {.companion = kOptional, .plane = true, .blocks = kNothing}},
    FeatureRow{FeatureKind::own_velocity,
               "own_velocity",
               "own velocity in {component}",
               FeatureMirror::by_component,
               {.component = kComponent, .velocity = true, .scale = true, .plane = true, .blocks = kNothing}},
    FeatureRow{FeatureKind::speed_change,
               "speed_change",
               "ln speed{of} against that in mode {mode}, average {alpha}",
               FeatureMirror::even,
               {.companion = kOptional, .alpha = true, .mode = true, .plane = true, .blocks = kModes}},
    FeatureRow{FeatureKind::velocity_change,
               "velocity_change",
               "change{of} in {component} against mode {mode}, average {alpha}",
               FeatureMirror::by_component,
               {.component = kComponent,
                .companion = kOptional,
                .velocity = true,
                .alpha = true,
                .scale = true,
                .mode = true,
                .plane = true,
                .blocks = kModes}},
    FeatureRow{FeatureKind::neighbour_closeness,
               "neighbour_closeness",
               "closeness of the neighbour",
               FeatureMirror::even,
               {.blocks = kNeighbour}},
    FeatureRow{FeatureKind::neighbour_difference,
               "neighbour_difference",
               "difference of the neighbour in {component}",
               FeatureMirror::by_component,
               {.component = kComponent, .scale = true, .blocks = kNeighbour}},
    FeatureRow{FeatureKind::log_interval, "log_interval", "ln interval", FeatureMirror::even, {.blocks = kInnovation}},
    FeatureRow{
        FeatureKind::sensor, "sensor", "sensor {sensor}", FeatureMirror::even, {.sensor = true, .blocks = kNothing}},
    FeatureRow{FeatureKind::frame_turn,
               "frame_turn",
               "turn of the velocity",
               FeatureMirror::odd,
               {.plane = true, .blocks = kNothing}},
};

}  // namespace detail

}  // namespace truebearing
