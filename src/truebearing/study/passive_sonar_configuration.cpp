// SPDX-License-Identifier: Apache-2.0
#include "truebearing/study/passive_sonar_configuration.hpp"

#include <toml++/toml.h>

#include "truebearing/core/chi_square.hpp"
#include "truebearing/study/measurement_kinds.hpp"
#include "truebearing/study/tracker_registry.hpp"
#include "truebearing/tracker/passive_sonar_tracker.hpp"

namespace truebearing {
namespace {

// The tracker of a sub-table, which inherits what it does not say of the sensor and the space.
std::unique_ptr<Tracker> make_part(TableReader& table, const std::string& part, const toml::table& defaults) {
  TableReader given = table.table(part);
  toml::table whole = *given.raw();
  const auto inherit = [&](const std::string& key, const toml::node* value) {
    if (value && !whole.contains(key)) whole.insert(key, *value);
  };
  for (const auto& [key, value] : defaults) inherit(std::string(key.str()), &value);
  inherit("measurement", table.node("measurement"));
  if (part == "filter" && table.has("space")) inherit("space", table.node("space"));
  TableReader reader(std::make_shared<const toml::table>(std::move(whole)), given.file(), given.path(), given.own());
  return make_tracker(reader.text("kind"), reader);
}

}  // namespace

std::unique_ptr<Tracker> make_passive_sonar_tracker(TableReader& table) {
  return make_passive_sonar_with(table, nullptr);
}

std::unique_ptr<Tracker> make_passive_sonar_with(TableReader& table, std::unique_ptr<Successor> given) {
  PassiveSonarOptions options;
  options.hand_over_s = table.number("hand_over_s", kNonNegative);
  options.hand_over_percent = table.number_or("hand_over_percent", options.hand_over_percent, kPositive);
  options.gamma = normal_quantile(1.0 - 0.5 * table.number_or("false_alarm_probability", 1.5e-6, {1e-15, 0.5}));
  options.manoeuvre_mps = table.number_or("manoeuvre_mps", options.manoeuvre_mps, kNonNegative);
  options.steady_probability = table.number_or("steady_probability", options.steady_probability, {0.0, 1.0});
  options.show_batch = table.boolean_or("show_batch", options.show_batch);
  if (measures(table, "bearing_frequency")) options.sensor = read_bearing_frequency_sensor(table);

  std::unique_ptr<Tracker> batch = make_part(table, "batch", toml::table{{"kind", "bearings_batch"}, {"method", "ml"}});
  if (given) return std::make_unique<PassiveSonarTracker>(std::move(options), std::move(batch), std::move(given));
  std::unique_ptr<Tracker> filter =
      make_part(table, "filter", toml::table{{"start", toml::table{{"kind", "hand_over"}}}});
  auto* successor = dynamic_cast<Successor*>(filter.get());
  if (!successor || !begins_in_plane(filter->space()))
    throw table.error("filter", "cannot take over from a batch", "kalman, unscented, modified_gain or imm");
  static_cast<void>(filter.release());
  std::unique_ptr<Successor> owned(successor);
  return std::make_unique<PassiveSonarTracker>(std::move(options), std::move(batch), std::move(owned));
}

}  // namespace truebearing
