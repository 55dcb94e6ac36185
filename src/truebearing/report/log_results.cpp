// SPDX-License-Identifier: Apache-2.0
#include "truebearing/report/log_results.hpp"

#include "truebearing/io/json_file.hpp"
#include "truebearing/report/result_reader.hpp"

namespace truebearing {
namespace {

constexpr JsonLimits kLogLimits{std::size_t{1} << 28, 64};

std::vector<std::pair<std::string, double>> read_values(const ResultReader& json) {
  std::vector<std::pair<std::string, double>> values;
  for (const auto& [name, value] : json.entries()) values.emplace_back(name, value.number());
  return values;
}

LogTracker read_log_tracker(const std::string& name, const ResultReader& json) {
  LogTracker tracker;
  tracker.name = name;
  tracker.no_track = json.text_or_none("no_track");
  tracker.steps = json.at("steps").number();
  const ResultReader nis = json.at("nis");
  tracker.nis_steps = nis.at("steps").number();
  tracker.nis_ratio = nis.at("ratio").number();
  tracker.nis_low = nis.at("low").number();
  tracker.nis_high = nis.at("high").number();
  tracker.correlation = json.at("correlation").at("value").number();
  tracker.correlation_limit = json.at("correlation").at("limit").number();
  tracker.counts = read_values(json.at("counts"));
  const ResultReader innovations = json.at("innovations");
  tracker.time_s = innovations.at("time_s").numbers();
  tracker.sigmas = innovations.at("sigmas").numbers();
  tracker.nis = innovations.at("nis").numbers();
  tracker.freedom = innovations.at("freedom").numbers();
  for (const ResultReader& one : innovations.at("used").items()) tracker.used.push_back(one.truth() ? 1.0 : 0.0);
  for (const std::vector<double>* column : {&tracker.sigmas, &tracker.nis, &tracker.freedom, &tracker.used})
    if (column->size() != tracker.time_s.size()) throw innovations.error("has columns of unequal length");
  for (const ResultReader& last : json.at("last").items())
    tracker.last.push_back({last.at("track").number(), last.at("time_s").number(), last.at("status").text(),
                            read_values(last.at("estimate")), read_values(last.at("standard_deviation"))});
  for (const ResultReader& one : json.at("not_used").items())
    tracker.not_used.push_back({one.at("time_s").number(), one.at("why").text(), one.at("nis").number()});
  return tracker;
}

}  // namespace

bool is_log_results(std::string_view text, const std::string& file) {
  const nlohmann::ordered_json parsed = parse_ordered_json(text, file, kLogLimits);
  return parsed.is_object() && parsed.contains("log") && parsed.contains("measurements");
}

LogResults read_log_results(const ResultReader& json) {
  LogResults results;
  results.study = json.at("study").text();
  results.log = json.at("log").text();
  results.version = json.text_or_none("version");
  results.measurements = json.at("measurements").number();
  results.missing = json.at("missing").number();
  results.repeated = json.at("repeated").number();
  results.run = json.number_or_nan("run");
  for (const ResultReader& warning : json.at("warnings").items()) results.warnings.push_back(warning.text());
  for (const auto& [name, tracker] : json.at("trackers").entries())
    results.trackers.push_back(read_log_tracker(name, tracker));
  for (const ResultReader& event : json.at("events").items())
    results.events.push_back({event.at("tracker").text(), event.at("event").text(), event.at("time_s").number(),
                              event.at("value").number()});
  results.foretelling = read_foretelling(json);
  if (json.has("picture")) results.picture = read_picture(json.at("picture"));
  return results;
}

LogResults parse_log_results(std::string_view text, const std::string& file) {
  const nlohmann::ordered_json parsed = parse_ordered_json(text, file, kLogLimits);
  return read_log_results(ResultReader(parsed, file));
}

}  // namespace truebearing
