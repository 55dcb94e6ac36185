// SPDX-License-Identifier: Apache-2.0
#include "truebearing/study/filter_trackers.hpp"

#include <cmath>
#include <fmt/format.h>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "truebearing/filter/filter_kinds.hpp"
#include "truebearing/filter/interacting_multiple_model.hpp"
#include "truebearing/filter/scaled_noise.hpp"
#include "truebearing/filter/shared_covariance_group.hpp"
#include "truebearing/study/filter_configuration.hpp"
#include "truebearing/study/measurement_kinds.hpp"
#include "truebearing/study/motion_kinds.hpp"
#include "truebearing/study/range_prior_configuration.hpp"
#include "truebearing/tracker/filter_bank.hpp"
#include "truebearing/tracker/range_bank.hpp"

namespace truebearing {
namespace {

// What the filters ask of measurements beyond a Jacobian.
// Of a range rate it is what a filter that linearises one estimate leaves out: points have it already, and a bank would
// take it of all its hypotheses together.
void refuse_second_order(const TableReader& tracker, const MeasurementChoice& measurement) {
  if (measurement.second_order)
    throw tracker.error("measurement.second_order", "is of a filter that linearises one estimate",
                        "kind = \"kalman\" or \"imm\" of such filters");
}

void check_filter(const TableReader& tracker, const std::string& key, FilterKind filter,
                  const MeasurementChoice& measurement) {
  const bool bearings = measurement.sensor->tells_bearing() && measurement.dimensions() == 2;
  if (filter == FilterKind::modified_gain && !bearings)
    throw tracker.error(key, "is \"modified_gain\", which \"" + measurement.model + "\" has none of",
                        "measurement.model = \"bearing\" or \"bearing_frequency\"");
  if (filter == FilterKind::log_polar && (measurement.model != "bearing" || measurement.has_frequency))
    throw tracker.error(key, "is \"log_polar\", whose coordinates \"" + measurement.model + "\" does not suit",
                        "measurement.model = \"bearing\"");
  if (filter != FilterKind::kalman) refuse_second_order(tracker, measurement);
}

std::unique_ptr<TrackedState> state_under(const TableReader& tracker, FilterKind filter,
                                          const std::shared_ptr<const AnyMotion>& motion) {
  std::unique_ptr<TrackedState> state = make_filter_state(filter, motion);
  if (!state)
    throw tracker.error("motion",
                        fmt::format("has a state of {} components, which this filter does not take", motion->states()),
                        filter == FilterKind::log_polar ? "constant_velocity or coordinated_turn" : "2 to 7, or 9");
  return state;
}

std::unique_ptr<Tracker> filter_tracker(TableReader& tracker, std::unique_ptr<TrackedState> state,
                                        MeasurementChoice measurement) {
  const Start start = read_start(tracker, measurement, state->size());
  const FilterTrackerOptions options = read_options(tracker, measurement);
  return std::make_unique<FilterTracker>(*measurement.space, std::move(state), std::move(measurement.sensor), start,
                                         options);
}

std::unique_ptr<Tracker> one_filter(TableReader& tracker, FilterKind filter) {
  MeasurementChoice measurement = read_measurement(tracker);
  check_filter(tracker, "kind", filter, measurement);
  const auto motion = read_motion(tracker.table("motion"), read_layout(tracker, measurement));
  return filter_tracker(tracker, state_under(tracker, filter, motion), std::move(measurement));
}

// filter = "kalman" | ...: of the modes of a multiple model, or the members of a bank.
FilterKind read_filter(TableReader& tracker, const MeasurementChoice& measurement, bool required,
                       std::vector<std::string> kinds) {
  const std::map<std::string, FilterKind> known{{"kalman", FilterKind::kalman},
                                                {"unscented", FilterKind::unscented},
                                                {"modified_gain", FilterKind::modified_gain},
                                                {"log_polar", FilterKind::log_polar}};
  const FilterKind filter =
      known.at(required ? tracker.choice("filter", kinds) : tracker.choice_or("filter", kinds, "kalman"));
  check_filter(tracker, "filter", filter, measurement);
  return filter;
}

}  // namespace

std::unique_ptr<Tracker> make_kalman_tracker(TableReader& table) {
  const std::string form = table.choice_or("form", {"joseph", "square_root", "conventional"}, "joseph");
  if (form == "square_root") return one_filter(table, FilterKind::square_root);
  if (form == "conventional") return one_filter(table, FilterKind::conventional);
  return one_filter(table, FilterKind::kalman);
}

std::unique_ptr<Tracker> make_unscented_tracker(TableReader& table) {
  return one_filter(table, FilterKind::unscented);
}

std::unique_ptr<Tracker> make_modified_gain_tracker(TableReader& table) {
  return one_filter(table, FilterKind::modified_gain);
}

std::unique_ptr<Tracker> make_log_polar_tracker(TableReader& table) {
  return one_filter(table, FilterKind::log_polar);
}

std::unique_ptr<Tracker> make_multiple_model_tracker(TableReader& table) {
  MeasurementChoice measurement = read_measurement(table);
  const std::vector<ModeChoice> choices = read_modes(table, read_layout(table, measurement));
  const MarkovChain chain = read_chain(table, static_cast<int>(choices.size()));
  const FilterKind filter = read_filter(table, measurement, false, {"kalman", "unscented", "modified_gain"});
  InteractingMultipleModel::Modes modes;
  for (const ModeChoice& choice : choices) {
    modes.push_back(state_under(table, filter, choice.motion));
    if (choice.sigma_factor != 1.0)
      modes.back() = std::make_unique<ScaledNoise>(std::move(modes.back()), choice.sigma_factor);
  }
  return filter_tracker(table, std::make_unique<InteractingMultipleModel>(std::move(modes), chain),
                        std::move(measurement));
}

std::unique_ptr<Tracker> make_kalman_bank(TableReader& table) {
  constexpr std::size_t kMost = 100000;
  const MeasurementChoice measurement = read_measurement(table);
  const FilterKind filter = read_filter(table, measurement, false, {"kalman", "unscented", "modified_gain"});
  refuse_second_order(table, measurement);
  if (measurement.is_lorenz())
    throw table.error("kind", "is \"kalman_bank\", which supposes velocities that \"lorenz\" has none of",
                      "measurements of a target on the line, in the plane or in space");
  const int d = measurement.dimensions();
  const std::vector<double> velocities = table.numbers("prior_velocities_mps");
  const std::vector<double> variance_factors = table.numbers("measurement_variance_factors", -1, kPositive);
  const std::vector<double> noise_factors = table.numbers("process_noise_factors", -1, kPositive);
  const std::size_t supposed = velocities.size() / static_cast<std::size_t>(d);
  const std::size_t filters = supposed * variance_factors.size() * noise_factors.size();
  if (velocities.size() % static_cast<std::size_t>(d) != 0)
    throw table.error("prior_velocities_mps", fmt::format("has {} numbers", velocities.size()),
                      d == 2 ? "pairs: East, North" : "triples: East, North, up");
  if (filters == 0 || filters > kMost)
    throw table.error("prior_velocities_mps", "makes a bank of " + std::to_string(filters), "1 to 100000 filters");

  AnyMotions motions;
  MotionLayout layout = read_layout(table, measurement);
  for (const double factor : noise_factors) {
    layout.process_noise_factor = factor;
    motions.push_back(read_motion(table.table("motion"), layout));
  }
  std::vector<std::unique_ptr<AnySensor>> sensors;
  for (const double factor : variance_factors) sensors.push_back(read_measurement(table, std::sqrt(factor)).sensor);

  TableReader start = table.table("start");
  start.choice_or("kind", {"prior"}, "prior");
  const PriorStart prior = read_prior_start(start, motions.front()->states());
  start.finish();
  std::vector<FilterBank::Hypothesis> hypotheses;
  std::vector<FilterGroup::Member> members;
  for (std::size_t s = 0; s < sensors.size(); ++s)
    for (std::size_t m = 0; m < motions.size(); ++m)
      for (std::size_t v = 0; v < supposed; ++v) {
        FilterBank::Hypothesis hypothesis{prior.x, prior.P};
        for (int i = 0; i < d; ++i) hypothesis.x[d + i] = velocities[v * static_cast<std::size_t>(d) + std::size_t(i)];
        hypotheses.push_back(hypothesis);
        members.push_back({m, s});
      }
  std::unique_ptr<FilterGroup> group;
  if (filter == FilterKind::kalman && measurement.sensor->measures_position())
    group = make_shared_covariance_group(motions, members, measurement.sensor->size());
  if (!group) group = make_filter_group(filter, motions, members);
  return std::make_unique<FilterBank>(*measurement.space, std::move(group), std::move(sensors), std::move(hypotheses),
                                      prior.time_s);
}

std::unique_ptr<Tracker> make_range_bank(TableReader& table) {
  MeasurementChoice measurement = read_measurement(table);
  if (!measurement.sensor->tells_bearing())
    throw table.error("kind", "is \"range_bank\", which supposes what bearings do not tell",
                      "measurement.model = \"bearing\" or \"bearing_frequency\"");
  const auto motion = read_motion(table.table("motion"), read_layout(table, measurement));
  const RangeHypotheses hypotheses = read_range_hypotheses(table, measurement.dimensions());
  const FilterKind filter =
      read_filter(table, measurement, true, {"kalman", "unscented", "log_polar", "modified_gain"});
  static_cast<void>(state_under(table, filter, motion));
  return range_bank(*measurement.space, filter, motion, std::move(measurement.sensor), hypotheses);
}

}  // namespace truebearing
