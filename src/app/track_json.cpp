// SPDX-License-Identifier: Apache-2.0
// What a log says without truth, for programs and for its page.
#include <cmath>
#include <nlohmann/json.hpp>

#include "app/track_report.hpp"
#include "truebearing/evaluation/details_json.hpp"
#include "truebearing/evaluation/six_digits.hpp"

namespace truebearing {
namespace {

using Json = nlohmann::ordered_json;

Json known(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

Json last_json(const StepRecord& record) {
  Json estimate = Json::object(), sigma = Json::object();
  for (Eigen::Index i = 0; i < record.x.size(); ++i) {
    const std::string& component = record.space->components[static_cast<std::size_t>(i)];
    estimate[component] = known(record.x[i]);
    sigma[component] = known(std::sqrt(record.P(i, i)));
  }
  return {{"track", record.track},
          {"time_s", record.time_s},
          {"status", to_string(record.status)},
          {"estimate", estimate},
          {"standard_deviation", sigma}};
}

Json innovations_json(const TrackerOnLog::Innovations& innovations) {
  Json used = Json::array();
  for (const bool one : innovations.used) used.push_back(one);
  return {{"time_s", innovations.time_s},
          {"sigmas", six_digits(innovations.sigmas)},
          {"nis", six_digits(innovations.nis)},
          {"freedom", innovations.freedom},
          {"used", used}};
}

Json not_used_json(const std::vector<TrackerOnLog::NotUsed>& not_used) {
  Json json = Json::array();
  for (const TrackerOnLog::NotUsed& one : not_used)
    json.push_back({{"time_s", one.time_s}, {"why", one.why}, {"nis", six_digits(one.nis)}});
  return json;
}

Json tracker_json(const Followed& followed, const TrackerOnLog& on_log, const std::string& why_none) {
  const InnovationConsistency& c = followed.innovations;
  Json json{{"steps", followed.records}};
  if (!why_none.empty()) json["no_track"] = why_none;
  json["nis"] = {{"steps", c.steps()},
                 {"ratio", known(c.nis_ratio())},
                 {"low", c.steps() > 0 ? known(c.nis_ratio_low()) : Json(nullptr)},
                 {"high", c.steps() > 0 ? known(c.nis_ratio_high()) : Json(nullptr)}};
  json["correlation"] = {{"value", known(c.correlation())}, {"limit", known(c.correlation_limit())}};
  const TrackerCounts& counts = followed.counts;
  json["counts"] = {{"missing", counts.missing},
                    {"repeated", counts.repeated},
                    {"late", counts.out_of_order},
                    {"gated", counts.gated},
                    {"failed", counts.failed}};
  json["last"] = Json::array();
  for (const StepRecord& record : followed.last) json["last"].push_back(last_json(record));
  json["innovations"] = innovations_json(on_log.innovations);
  json["not_used"] = not_used_json(on_log.not_used);
  return json;
}

}  // namespace

Json log_json(const TrackedLog& tracked, const std::vector<Followed>& all) {
  Json json{{"study", tracked.study},
            {"log", tracked.log},
            {"version", TRUEBEARING_VERSION},
            {"measurements", tracked.measurements},
            {"missing", tracked.rows.missing},
            {"repeated", tracked.rows.repeated},
            {"warnings", consistency_warnings(all)}};
  if (tracked.run) json["run"] = *tracked.run;
  json["trackers"] = Json::object();
  for (std::size_t i = 0; i < all.size(); ++i)
    json["trackers"][all[i].name] = tracker_json(all[i], tracked.account.trackers[i], tracked.why_none[i]);
  json["events"] = Json::array();
  for (const Followed& followed : all)
    for (const TrackEvent& event : followed.events)
      json["events"].push_back({{"tracker", followed.name},
                                {"time_s", event.time_s},
                                {"event", to_string(event.kind)},
                                {"value", known(event.value)}});
  json["picture"] = picture_json(tracked.account.picture);
  return json;
}

}  // namespace truebearing
