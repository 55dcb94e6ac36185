// SPDX-License-Identifier: Apache-2.0
#include "truebearing/evaluation/details_json.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "truebearing/evaluation/correction_json.hpp"
#include "truebearing/evaluation/six_digits.hpp"

namespace truebearing {
namespace {

using OrderedJson = nlohmann::ordered_json;

// A picture is some 500 points wide: of a longer run every n-th step is drawn.
constexpr std::size_t kMostDrawnSteps = 500;

// Times are not rounded: those of a log may be seconds of an epoch.
OrderedJson times_json(const std::vector<double>& values, std::size_t every) {
  OrderedJson array = OrderedJson::array();
  for (std::size_t i = 0; i < values.size(); i += every) array.push_back(values[i]);
  return array;
}

OrderedJson line_json(const DrawnLine& line, std::size_t every) {
  OrderedJson json{{"track", line.track}, {"time_s", times_json(line.time_s, every)}};
  if (!line.x.empty()) json["x"] = six_digits(line.x, every);
  json["y"] = six_digits(line.y, every);
  return json;
}

OrderedJson track_json(const DrawnTrack& track, std::size_t every) {
  OrderedJson json{{"tracker", track.tracker}};
  json.update(line_json(track.line, every));
  if (!track.xx.empty()) {
    json["xx"] = six_digits(track.xx, every);
    json["xy"] = six_digits(track.xy, every);
  }
  json["yy"] = six_digits(track.yy, every);
  return json;
}

// To the decibel, which is what shades can show.
OrderedJson beam_json(const DrawnBeam& beam) {
  OrderedJson json{{"time_s", times_json(beam.time_s, 1)}, {"angle_deg", six_digits(beam.angle_deg)}};
  json["below_dB"] = OrderedJson::array();
  for (const std::vector<double>& at_time : beam.below_dB) {
    OrderedJson row = OrderedJson::array();
    for (const double below_dB : at_time)
      row.push_back(std::isfinite(below_dB) ? OrderedJson(std::lround(below_dB)) : OrderedJson(nullptr));
    json["below_dB"].push_back(std::move(row));
  }
  return json;
}

}  // namespace

nlohmann::ordered_json picture_json(const RunPicture& picture) {
  std::size_t steps = 0;
  for (const DrawnLine& truth : picture.truth) steps = std::max(steps, truth.time_s.size());
  for (const DrawnTrack& track : picture.tracks) steps = std::max(steps, track.line.time_s.size());
  steps = std::max({steps, picture.measured.time_s.size(), picture.own_ship.time_s.size()});
  const std::size_t every = steps / (kMostDrawnSteps + 1) + 1;
  OrderedJson json{{"which", picture.which}, {"run", picture.run}};
  if (!picture.set.empty()) json["set"] = picture.set;
  json["judged_by"] = picture.judged_by;
  json["quantity"] = picture.quantity;
  json["rmse"] = six_digits(picture.rmse);
  json["every"] = every;
  if (picture.in_plane)
    json["plane"] = true;
  else
    json["component"] = picture.component;
  json["truth"] = OrderedJson::array();
  for (const DrawnLine& truth : picture.truth) json["truth"].push_back(line_json(truth, every));
  if (!picture.measured.y.empty()) json["measured"] = line_json(picture.measured, every);
  if (!picture.own_ship.y.empty()) {
    json["own_ship"] = line_json(picture.own_ship, every);
    json["own_ship"]["bearing_deg"] = six_digits(picture.bearing_deg, every);
  }
  if (!picture.beam.time_s.empty()) json["beam"] = beam_json(picture.beam);
  if (std::isfinite(picture.assigned_within)) json["assigned_within"] = picture.assigned_within;
  json["tracks"] = OrderedJson::array();
  for (const DrawnTrack& track : picture.tracks) json["tracks"].push_back(track_json(track, every));
  return json;
}

void add_details(const Comparison& comparison, const std::vector<RunPicture>& pictures, OrderedJson& results) {
  for (std::size_t i = 0; i < comparison.details.size(); ++i) {
    const TrackerSummary& summary = comparison.trackers[i];
    const TrackerDetails& details = comparison.details[i];
    OrderedJson run_rmse = OrderedJson::object(), series_se = OrderedJson::object();
    for (std::size_t q = 0;
         q < std::min({summary.quantities.size(), details.run_rmse.size(), details.series_se.size()}); ++q) {
      run_rmse[summary.quantities[q].name] = six_digits(details.run_rmse[q]);
      series_se[summary.quantities[q].name] = six_digits(details.series_se[q]);
    }
    results["trackers"][summary.name]["details"] = {{"run_rmse", run_rmse},
                                                    {"series_se", series_se},
                                                    {"nees", six_digits(details.nees)},
                                                    {"nees_low", six_digits(details.nees_low)},
                                                    {"nees_high", six_digits(details.nees_high)}};
  }
  for (std::size_t i = 0; i < comparison.corrections.size(); ++i)
    if (const std::optional<CorrectionDetails>& correction = comparison.corrections[i])
      results["trackers"][comparison.trackers[i].name]["details"]["correction"] = correction_json(*correction);
  for (const auto& [name, set] : comparison.sets)
    for (std::size_t i = 0; i < set.corrections.size(); ++i)
      if (const std::optional<CorrectionDetails>& correction = set.corrections[i])
        results["sets"][name]["trackers"][set.trackers[i].name]["details"]["correction"] =
            correction_steps_json(*correction);
  for (const RunPicture& picture : pictures) results["pictures"].push_back(picture_json(picture));
}

}  // namespace truebearing
