// SPDX-License-Identifier: Apache-2.0
#include "app/track_foretelling.hpp"

#include <fmt/format.h>
#include <limits>
#include <nlohmann/json.hpp>

#include "app/output.hpp"
#include "truebearing/core/error.hpp"
#include "truebearing/evaluation/six_digits.hpp"
#include "truebearing/io/json_file.hpp"

namespace truebearing {
namespace {

using Json = nlohmann::ordered_json;

Json foretelling_json(const ForetoldLog& log) {
  const Foretelling& told = log.told;
  Json json{{"track", log.number},
            {"steps", told.steps},
            {"quantity", told.quantity},
            {"measurements", told.foretold},
            {"best", told.trackers[told.best].name},
            {"says", foretelling_verdict(told)},
            {"trackers", Json::object()},
            {"left_out", told.left_out}};
  for (const Foretelling::Tracker& one : told.trackers)
    json["trackers"][one.name] = {{"rmse", six_digits(one.rmse.value)},
                                  {"rmse_se", six_digits(one.rmse.se)},
                                  {"squared_above_best", six_digits(one.above_best.value)},
                                  {"squared_above_best_se", six_digits(one.above_best.se)},
                                  {"mean_gate", six_digits(one.mean_gate)}};
  return json;
}

}  // namespace

std::vector<ForetoldLog> foretell(const TrackerSet& trackers, const std::string& log, const KeptLogs& logs,
                                  double epoch_s, int steps, const SensorSites& sites) {
  std::vector<ForetoldLog> all;
  for (const auto& [number, recording] : logs) {
    Recording timed = recording;
    for (Measurement& measurement : timed.measurements) measurement.time_s -= epoch_s;
    try {
      all.push_back({number, foretell(trackers, timed, steps, sites)});
    } catch (const InputError& error) {  // the others, and what else is told of this one, stand
      say(fmt::format("truebearing: {}{}: --foretell: {}", log, logs.size() > 1 ? fmt::format(" track {}", number) : "",
                      error.what()));
    }
  }
  return all;
}

std::string with_foretelling(std::string results, const std::vector<ForetoldLog>& all) {
  if (all.empty()) return results;
  Json json = parse_ordered_json(results, "results", {std::numeric_limits<std::size_t>::max(), 64});
  json["foretelling"] = Json::array();
  for (const ForetoldLog& log : all) json["foretelling"].push_back(foretelling_json(log));
  return json_text(json);
}

}  // namespace truebearing
