// SPDX-License-Identifier: Apache-2.0
// Small results as the JSON of `compare --json`: two trackers, a bound, a pair, three runs of four steps.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace truebearing::testing {

using ResultJson = nlohmann::ordered_json;

inline ResultJson tracker_json(double rmse, double nees, bool details) {
  ResultJson json{
      {"rmse", {{"position_m", rmse}}},
      {"rmse_se", {{"position_m", rmse / 50.0}}},
      {"median", {{"position_m", 0.8 * rmse}}},
      {"loss_rate", 0.0},
      {"nees", nees},
      {"nees_expected", 2},
      {"coverage95", 0.95},
      {"ns_per_step", 21.0},
      {"scored_steps", 12},
      {"metrics", ResultJson::array()},
      {"series",
       {{"time_s", {1.0, 2.0, 3.0, 4.0}}, {"rmse", {{"position_m", {nullptr, 1.2 * rmse, rmse, 0.8 * rmse}}}}}}};
  if (details)
    json["details"] = {{"run_rmse", {{"position_m", {0.5 * rmse, rmse, 1.5 * rmse}}}},
                       {"series_se", {{"position_m", {nullptr, 0.1 * rmse, 0.1 * rmse, 0.1 * rmse}}}},
                       {"nees", {nullptr, nees, nees, nees}},
                       {"nees_low", {nullptr, 0.4, 0.4, 0.4}},
                       {"nees_high", {nullptr, 4.8, 4.8, 4.8}}};
  return json;
}

/// Two rules over two features, in three of the four steps.
inline ResultJson correction_json() {
  const auto feature = [](const char* name, double outside) {
    return ResultJson{{"name", name},
                      {"mean", 1.0},
                      {"scale", 0.5},
                      {"clip", 4.0},
                      {"low", 0.0},
                      {"high", 2.0},
                      {"seen",
                       {{"mean", 1.25},
                        {"deviation", 0.5},
                        {"least", 0.1},
                        {"greatest", 2.5},
                        {"outside", outside},
                        {"counted", {0.0, 3.0, 6.0, 0.0}}}}};
  };
  const auto rule = [](const char* conditions, double usage, double fired) {
    return ResultJson{{"if", conditions}, {"add", "+12 m"},     {"taught", "+11 m"},      {"usage", usage},
                      {"fired", fired},   {"strongest", fired}, {"centre", {0.5, usage}}, {"width", {0.2, 0.3}}};
  };
  return {{"network", "nfnn"},
          {"size", "2 rules"},
          {"base", "plain"},
          {"reference", "tuned"},
          {"bounds", "kappa 3, gate, no referee"},
          {"kappa", 3.0},
          {"steps", 12.0},
          {"asked", 9.0},
          {"outside_intervals", 0.25},
          {"outside_disagreement", 0.0},
          {"by_step",
           {{"gate", {nullptr, 1.0, 0.5, 0.9}},
            {"box", {nullptr, 1.0, 0.5, 0.9}},
            {"referee", {nullptr, 1.0, 1.0, 1.0}},
            {"limited", {nullptr, 0.0, 0.25, 0.0}},
            {"handed_over", {nullptr, 0.0, 0.0, 0.0}},
            {"wanted_sigmas", {nullptr, 1.0, 4.0, 2.0}},
            {"moved_sigmas", {nullptr, 1.0, 1.5, 1.8}}}},
          {"features", {feature("gain in position_m", 0.125), feature("ln step", 0.0)}},
          {"rules", {rule("gain is SMALL", 0.7, 0.4), rule("gain is LARGE", 0.3, 0.6)}}};
}

inline ResultJson picture_json() {
  const ResultJson line{{"track", 0},
                        {"time_s", {1.0, 2.0, 3.0, 4.0}},
                        {"x", {0.0, 100.0, 200.0, 300.0}},
                        {"y", {0.0, 10.0, 30.0, 60.0}}};
  ResultJson track{{"tracker", "nfnn"}};
  track.update(line);
  track["xx"] = {100.0, 100.0, 100.0, 100.0};
  track["xy"] = {50.0, 0.0, 0.0, 0.0};
  track["yy"] = {100.0, 100.0, 100.0, 100.0};
  ResultJson own = line;
  own["bearing_deg"] = {10.0, nullptr, 20.0, 30.0};
  return {{"which", "median"},   {"run", 1},
          {"judged_by", "nfnn"}, {"quantity", "position_m"},
          {"rmse", 86.0},        {"every", 1},
          {"plane", true},       {"truth", ResultJson::array({line})},
          {"own_ship", own},     {"tracks", ResultJson::array({track})}};
}

/// nfnn errs 14 % less than tuned, by 9 standard errors.
inline ResultJson results_json(bool details = true) {
  ResultJson json{{"study", "small"}, {"seed", 5}, {"runs", 3}, {"version", "0.1.0"}};
  json["trackers"]["tuned"] = tracker_json(100.0, 2.0, details);
  json["trackers"]["nfnn"] = tracker_json(86.0, 2.1, details);
  json["trackers"]["nfnn"]["correction"] = {{"mean_gate", 0.9}, {"limited_share", 0.01}};
  json["trackers"]["bank"] = tracker_json(80.0, 2.0, details);
  json["bounds"]["bank"] = {{"position_m", 80.0}, {"series", json["trackers"]["bank"]["series"]}};
  json["paired"]["nfnn - tuned"] = {{"position_m", {{"mean", -14.4}, {"se", 1.6}}}};
  if (details) json["pictures"] = ResultJson::array({picture_json()});
  return json;
}

}  // namespace truebearing::testing
