// SPDX-License-Identifier: Apache-2.0
#include "truebearing/study/batch_trackers.hpp"

#include <algorithm>

#include "truebearing/core/angle.hpp"
#include "truebearing/study/range_prior_configuration.hpp"

namespace truebearing {
namespace {

TargetMotionBatchOptions read_own_method(TableReader& table) {
  TargetMotionBatchOptions options;
  options.start_grid = table.boolean_or("start_grid", false);
  if (table.has("start_ranges_m")) options.start_ranges_m = table.numbers("start_ranges_m", -1, {10.0, 1e6});
  if (options.start_ranges_m.empty() && !options.start_grid)
    throw table.error("start_ranges_m", "is empty", "one range or more, or start_grid = true");
  options.huber_sigmas = table.number_or("huber_sigmas", options.huber_sigmas, {0.1, 1e300});
  return options;
}

ChoOptions read_cho(TableReader& table, const std::string& method) {
  using Method = ChoOptions::Method;
  using Inverse = ChoOptions::Inverse;
  ChoOptions options;
  if (method == "levenberg") options.method = Method::levenberg;
  if (method != "gauss_newton") return options;
  options.method = Method::gauss_newton;
  const std::string inverse = table.choice_or("inverse", {"cofactor", "cofactor_float", "pivoted"}, "cofactor");
  if (inverse == "cofactor_float") options.inverse = Inverse::cofactor_float;
  if (inverse == "pivoted") options.inverse = Inverse::pivoted;
  return options;
}

FrequencyChangeOptions read_changes(TableReader& table) {
  using Handling = FrequencyChangeOptions::Handling;
  FrequencyChangeOptions options;
  const std::string handling =
      table.choice_or("frequency_changes", {"levels", "segments", "switch", "ignored"}, "levels");
  if (handling == "segments") options.handling = Handling::segments;
  if (handling == "switch") options.handling = Handling::bearings_only;
  if (handling == "ignored") options.handling = Handling::ignored;
  options.false_alarm_probability =
      table.number_or("false_alarm_probability", options.false_alarm_probability, {1e-15, 0.5});
  options.scan_threshold = table.number_or("scan_threshold", options.scan_threshold, kPositive);
  return options;
}

std::variant<RangePrior, VelocityPrior> read_prior(TableReader table) {
  if (table.choice("kind", {"range", "velocity"}) == "range") return read_range_prior(std::move(table));
  const VelocityPrior prior{table.number("velocity_sigma_mps", kPositive)};
  table.finish();
  return prior;
}

}  // namespace

std::unique_ptr<Tracker> make_bearings_batch(TableReader& table) {
  BearingsBatchOptions options;
  const std::string method = table.choice("method", {"ml", "map", "gauss_newton", "levenberg", "levenberg_marquardt"});
  if (method == "ml" || method == "map") {
    options.method = read_own_method(table);
    options.warm_start = table.boolean_or("warm_start", false);
    options.cut_at_manoeuvres = table.boolean_or("cut_at_manoeuvres", false);
  } else {
    options.method = read_cho(table, method);
  }
  if (method == "map") options.prior = read_prior(table.table("prior"));

  TableReader measurement = table.table("measurement");
  const bool has_frequency = measurement.choice("model", {"bearing", "bearing_frequency"}) == "bearing_frequency";
  if (has_frequency && std::holds_alternative<ChoOptions>(options.method))
    throw measurement.error("model", "is \"bearing_frequency\" of method \"" + method + "\", which takes bearings only",
                            "\"bearing\", or method \"ml\" or \"map\"");
  options.sigma_rad = radians(measurement.number("bearing_sigma_deg", {0.0, 90.0, true}));
  options.sigma_factor = measurement.number_or("sigma_factor", 1.0, kPositive);
  if (has_frequency) {
    BatchFrequencyOptions& frequency = options.frequency.emplace();
    frequency.sigma_hz = measurement.number("frequency_sigma_hz", kPositive);
    frequency.sound_mps = measurement.number_or("sound_mps", kSoundInWater_mps, kPositive);
    frequency.changes = read_changes(table);
  }
  measurement.finish();

  options.window_s = table.number_or("window_s", options.window_s, kPositive);
  if (table.has("solve_at_s")) {
    options.solve_at_s = table.numbers("solve_at_s", -1, kNonNegative);
    if (table.has("solve_every_s")) throw table.error("solve_every_s", "stands beside solve_at_s", "one of them");
    if (!std::is_sorted(options.solve_at_s.begin(), options.solve_at_s.end()))
      throw table.error("solve_at_s", "is not in order", "times that rise");
  }
  options.solve_every_s = table.number_or("solve_every_s", 0.0, kNonNegative);
  return std::make_unique<BearingsBatchTracker>(std::move(options));
}

}  // namespace truebearing
