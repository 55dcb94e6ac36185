// SPDX-License-Identifier: Apache-2.0
#include "truebearing/report/results.hpp"

#include <algorithm>

#include "truebearing/io/file.hpp"
#include "truebearing/io/json_file.hpp"
#include "truebearing/report/log_results.hpp"
#include "truebearing/report/result_reader.hpp"

namespace truebearing {
namespace {

// A study of 65536 runs with all its details takes a quarter of this.
constexpr std::size_t kMostResultBytes = std::size_t{1} << 28;

ResultMetric read_metric(const ResultReader& json) {
  ResultMetric metric;
  metric.name = json.at("name").text();
  metric.unit = json.at("unit").text();
  if (json.has("time_s")) metric.time_s = json.at("time_s").number();
  metric.value = json.at("value").number();
  metric.se = json.number_or_nan("se");
  return metric;
}

void read_metrics_of(const ResultReader& json, ResultTracker& tracker) {
  if (!json.has("metrics")) return;
  for (const ResultReader& metric : json.at("metrics").items()) tracker.metrics.push_back(read_metric(metric));
}

ResultQuantity& quantity_of(ResultTracker& tracker, const std::string& name) {
  for (ResultQuantity& quantity : tracker.quantities)
    if (quantity.name == name) return quantity;
  tracker.quantities.push_back({});
  tracker.quantities.back().name = name;
  return tracker.quantities.back();
}

void read_series(const ResultReader& json, ResultTracker& tracker) {
  if (!json.has("series")) return;
  const ResultReader series = json.at("series");
  tracker.time_s = series.at("time_s").numbers();
  for (const auto& [name, values] : series.at("rmse").entries()) quantity_of(tracker, name).series = values.numbers();
}

ResultCorrection::Feature read_feature(const ResultReader& json) {
  ResultCorrection::Feature feature;
  feature.name = json.at("name").text();
  feature.mean = json.at("mean").number();
  feature.scale = json.at("scale").number();
  feature.clip = json.at("clip").number();
  feature.low = json.at("low").number();
  feature.high = json.at("high").number();
  const ResultReader seen = json.at("seen");
  feature.seen_mean = seen.at("mean").number();
  feature.seen_deviation = seen.at("deviation").number();
  feature.least = seen.at("least").number();
  feature.greatest = seen.at("greatest").number();
  feature.outside = seen.at("outside").number();
  feature.counted = seen.at("counted").numbers();
  return feature;
}

ResultCorrection::Rule read_rule(const ResultReader& json, std::size_t features) {
  ResultCorrection::Rule rule;
  rule.conditions = json.at("if").text();
  rule.adds = json.at("add").text();
  rule.taught = json.at("taught").text();
  rule.usage = json.at("usage").number();
  rule.fired = json.at("fired").number();
  rule.strongest = json.at("strongest").number();
  rule.centre = json.at("centre").numbers();
  rule.width = json.at("width").numbers();
  if (rule.centre.size() != features || rule.width.size() != features)
    throw json.error("has terms that are not one per feature");
  return rule;
}

ResultCorrection read_correction(const ResultReader& json) {
  ResultCorrection correction;
  correction.network = json.text_or_none("network");
  correction.size = json.text_or_none("size");
  correction.base = json.text_or_none("base");
  correction.reference = json.text_or_none("reference");
  correction.bounds = json.text_or_none("bounds");
  correction.kappa = json.number_or_nan("kappa");
  correction.steps = json.at("steps").number();
  correction.asked = json.at("asked").number();
  correction.outside_intervals = json.at("outside_intervals").number();
  correction.outside_disagreement = json.at("outside_disagreement").number();
  const ResultReader by_step = json.at("by_step");
  correction.gate = by_step.at("gate").numbers();
  correction.box = by_step.at("box").numbers();
  correction.referee = by_step.at("referee").numbers();
  correction.limited = by_step.at("limited").numbers();
  correction.handed_over = by_step.at("handed_over").numbers();
  correction.wanted_sigmas = by_step.at("wanted_sigmas").numbers();
  correction.moved_sigmas = by_step.at("moved_sigmas").numbers();
  if (json.has("features"))
    for (const ResultReader& feature : json.at("features").items())
      correction.features.push_back(read_feature(feature));
  if (json.has("rules"))
    for (const ResultReader& rule : json.at("rules").items())
      correction.rules.push_back(read_rule(rule, correction.features.size()));
  return correction;
}

void read_details(const ResultReader& json, ResultTracker& tracker) {
  if (!json.has("details")) return;
  const ResultReader details = json.at("details");
  if (details.has("correction")) tracker.correction = read_correction(details.at("correction"));
  if (!details.has("run_rmse")) return;  // of one set, whose figures are all that is kept of it
  for (const auto& [name, values] : details.at("run_rmse").entries())
    quantity_of(tracker, name).run_rmse = values.numbers();
  for (const auto& [name, values] : details.at("series_se").entries())
    quantity_of(tracker, name).series_se = values.numbers();
  tracker.nees_of = details.at("nees").numbers();
  tracker.nees_low = details.at("nees_low").numbers();
  tracker.nees_high = details.at("nees_high").numbers();
}

ResultTracker read_tracker(const std::string& name, const ResultReader& json) {
  ResultTracker tracker;
  tracker.name = name;
  for (const auto& [quantity, rmse] : json.at("rmse").entries()) quantity_of(tracker, quantity).rmse = rmse.number();
  const auto read = [&](const char* key, double ResultQuantity::*member) {
    if (!json.has(key)) return;
    for (const auto& [quantity, value] : json.at(key).entries())
      quantity_of(tracker, quantity).*member = value.number();
  };
  read("rmse_se", &ResultQuantity::rmse_se);
  read("median", &ResultQuantity::median);
  read("ratio_to_plain", &ResultQuantity::ratio_to_plain);
  tracker.nees = json.number_or_nan("nees");
  tracker.nees_expected = json.number_or_nan("nees_expected");
  tracker.coverage95 = json.number_or_nan("coverage95");
  tracker.loss_rate = json.number_or_nan("loss_rate");
  tracker.ns_per_step = json.number_or_nan("ns_per_step");
  tracker.corrected = json.has("correction");
  if (tracker.corrected) tracker.mean_gate = json.at("correction").number_or_nan("mean_gate");
  read_metrics_of(json, tracker);
  read_series(json, tracker);
  read_details(json, tracker);
  return tracker;
}

// A bound's RMSE stand beside its series.
ResultTracker read_bound(const std::string& name, const ResultReader& json) {
  ResultTracker bound;
  bound.name = name;
  bound.is_bound = true;
  for (const auto& [key, value] : json.entries())
    if (value.is_number()) quantity_of(bound, key).rmse = value.number();
  read_metrics_of(json, bound);
  read_series(json, bound);
  return bound;
}

ResultPublished read_published(const std::string& name, const ResultReader& json) {
  ResultPublished row{name, json.at("source").text(), {}};
  for (const auto& [key, value] : json.entries())
    if (key != "source") row.figures.emplace_back(key, value.number());
  return row;
}

ResultFigures read_figures(const ResultReader& json) {
  ResultFigures figures;
  for (const auto& [name, tracker] : json.at("trackers").entries())
    figures.trackers.push_back(read_tracker(name, tracker));
  if (json.has("bounds"))
    for (const auto& [name, bound] : json.at("bounds").entries()) {
      const auto tracker = std::find_if(figures.trackers.begin(), figures.trackers.end(),
                                        [&, &name = name](const ResultTracker& t) { return t.name == name; });
      if (tracker != figures.trackers.end())
        tracker->is_bound = true;
      else
        figures.bounds.push_back(read_bound(name, bound));
    }
  if (json.has("published"))
    for (const auto& [name, row] : json.at("published").entries())
      figures.published.push_back(read_published(name, row));
  if (!json.has("paired")) return figures;
  for (const auto& [pair, quantities] : json.at("paired").entries()) {
    const std::size_t dash = pair.find(" - ");
    if (dash == std::string::npos) throw quantities.error("is no \"a - b\"");
    for (const auto& [quantity, difference] : quantities.entries())
      if (quantity != "at_times")
        figures.pairs.push_back({pair.substr(0, dash), pair.substr(dash + 3), quantity, difference.at("mean").number(),
                                 difference.at("se").number()});
  }
  return figures;
}

ResultLine read_line(const ResultReader& json) {
  ResultLine line;
  constexpr double kMost = 1e9;
  if (const double track = json.number_or_nan("track"); std::abs(track) <= kMost) line.track = static_cast<int>(track);
  line.time_s = json.at("time_s").numbers();
  line.x = json.numbers_or_none("x");
  line.y = json.at("y").numbers();
  if (line.y.size() != line.time_s.size() || (!line.x.empty() && line.x.size() != line.y.size()))
    throw json.error("has columns of unequal length");
  return line;
}

ResultTrack read_track(const ResultReader& json) {
  ResultTrack track;
  track.tracker = json.at("tracker").text();
  track.line = read_line(json);
  track.xx = json.numbers_or_none("xx");
  track.xy = json.numbers_or_none("xy");
  track.yy = json.at("yy").numbers();
  const std::size_t steps = track.line.y.size(), in_plane = track.line.x.size();
  if (track.yy.size() != steps || track.xx.size() != in_plane || track.xy.size() != in_plane)
    throw json.error("has columns of unequal length");
  return track;
}

void read_beam(const ResultReader& json, ResultPicture& picture) {
  picture.beam_time_s = json.at("time_s").numbers();
  picture.beam_angle_deg = json.at("angle_deg").numbers();
  for (const ResultReader& at_time : json.at("below_dB").items()) {
    picture.below_dB.push_back(at_time.numbers());
    if (picture.below_dB.back().size() != picture.beam_angle_deg.size())
      throw at_time.error("has columns of unequal length");
  }
  if (picture.below_dB.size() != picture.beam_time_s.size()) throw json.error("has columns of unequal length");
}

}  // namespace

ResultPicture read_picture(const ResultReader& json) {
  ResultPicture picture;
  picture.which = json.at("which").text();
  picture.set = json.text_or_none("set");
  picture.judged_by = json.at("judged_by").text();
  picture.quantity = json.at("quantity").text();
  picture.component = json.text_or_none("component");
  picture.run = json.at("run").number();
  picture.rmse = json.at("rmse").number();
  picture.every = json.at("every").number();
  picture.in_plane = json.has("plane");
  for (const ResultReader& truth : json.at("truth").items()) picture.truth.push_back(read_line(truth));
  if (json.has("measured")) picture.measured = read_line(json.at("measured"));
  if (json.has("own_ship")) {
    picture.own_ship = read_line(json.at("own_ship"));
    picture.bearing_deg = json.at("own_ship").numbers_or_none("bearing_deg");
  }
  for (const ResultReader& track : json.at("tracks").items()) {
    picture.tracks.push_back(read_track(track));
    for (const ResultLine& truth : picture.truth)
      if (truth.x.empty() != picture.tracks.back().line.x.empty())
        throw track.error("and the truth are not both in the plane");
  }
  picture.assigned_within = json.number_or_nan("assigned_within");
  if (json.has("beam")) read_beam(json.at("beam"), picture);
  return picture;
}

const ResultQuantity* ResultTracker::quantity(std::string_view quantity_name) const {
  for (const ResultQuantity& quantity : quantities)
    if (quantity.name == quantity_name) return &quantity;
  return nullptr;
}

const ResultTracker* ResultFigures::tracker(std::string_view name) const {
  for (const ResultTracker& tracker : trackers)
    if (tracker.name == name) return &tracker;
  return nullptr;
}

Results parse_results(std::string_view text, const std::string& file) {
  const nlohmann::ordered_json parsed = parse_ordered_json(text, file, {kMostResultBytes, 64});
  const ResultReader json(parsed, file);
  Results results;
  results.file = file;
  results.study = json.at("study").text();
  results.version = json.text_or_none("version");
  results.seed = json.number_or_nan("seed");
  results.runs = json.at("runs").number();
  results.all = read_figures(json);
  if (results.all.trackers.empty()) throw json.error("holds no tracker");
  if (json.has("sets"))
    for (const auto& [name, set] : json.at("sets").entries()) results.sets.push_back({name, read_figures(set)});
  results.foretelling = read_foretelling(json);
  if (json.has("pictures"))
    for (const ResultReader& picture : json.at("pictures").items()) results.pictures.push_back(read_picture(picture));
  if (json.has("on_log")) results.on_log = std::make_shared<const LogResults>(read_log_results(json.at("on_log")));
  return results;
}

Results read_results(const std::filesystem::path& file) {
  return parse_results(read_text_file(file, kMostResultBytes), file.string());
}

}  // namespace truebearing
