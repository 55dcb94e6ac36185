// SPDX-License-Identifier: Apache-2.0
#include "app/track_report.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

#include "truebearing/core/angle.hpp"
#include "truebearing/evaluation/metric.hpp"
#include "truebearing/evaluation/text_table.hpp"

namespace truebearing {
namespace {

using Rows = std::vector<std::vector<std::string>>;

// Whole where it is whole, also of a time of day; at most to the microsecond.
std::string whole_or_decimal(double value) {
  if (!(std::abs(value) < 1e12)) return fmt::format("{:g}", value);
  std::string text = fmt::format("{:.6f}", value);
  text.erase(text.find_last_not_of('0') + 1);
  if (text.back() == '.') text.pop_back();
  return text == "-0" ? "0" : text;
}

std::string marked(const std::string& text, bool outside) {
  return text + (outside ? " *" : "");
}

std::string nis_of(const InnovationConsistency& c) {
  if (c.steps() == 0) return "-";
  return marked(fmt::format("{:.2f} ({:.2f}-{:.2f})", c.nis_ratio(), c.nis_ratio_low(), c.nis_ratio_high()),
                c.nis_ratio() < c.nis_ratio_low() || c.nis_ratio() > c.nis_ratio_high());
}

std::string correlation_of(const InnovationConsistency& c) {
  if (c.steps() < 2 || std::isnan(c.correlation())) return "-";
  return marked(fmt::format("{:+.3f} (+-{:.3f})", c.correlation(), c.correlation_limit()),
                std::abs(c.correlation()) > c.correlation_limit());
}

// A component of a state as it is printed: angles in degrees.
struct Shown {
  std::string title;
  double factor;
};

Shown shown(std::string component) {
  double factor = 1.0;
  if (const std::size_t unit = component.rfind("_rad"); unit != std::string::npos) {
    component.replace(unit, 4, "_deg");
    factor = degrees(1.0);
  }
  return {title_of(component), factor};
}

// With as many digits as the standard deviation leaves sense in.
std::string with_spread(double value, double sigma) {
  if (!std::isfinite(value) || !(sigma > 0.0) || !(sigma < 1e12) || !(std::abs(value) < 1e12))
    return fmt::format("{:g} +- {:g}", value, sigma);
  const int decimals = std::clamp(1 - static_cast<int>(std::floor(std::log10(sigma))), 0, 9);
  return fmt::format("{:.{}f} +- {:.{}f}", value, decimals, sigma, decimals);
}

std::string component_of(const StepRecord& record, const std::string& component) {
  const int i = record.space->component_index(component);
  if (i < 0) return "-";
  const double factor = shown(component).factor;
  return with_spread(factor * record.x[i], factor * std::sqrt(record.P(i, i)));
}

// Of all trackers, each once.
std::vector<std::string> components_of(const std::vector<Followed>& all) {
  std::vector<std::string> components;
  for (const Followed& followed : all)
    for (const StepRecord& record : followed.last)
      for (const std::string& component : record.space->components)
        if (std::find(components.begin(), components.end(), component) == components.end())
          components.push_back(component);
  return components;
}

bool has_several_tracks(const std::vector<Followed>& all) {
  return std::any_of(all.begin(), all.end(), [](const Followed& followed) {
    return followed.last.size() > 1 || (!followed.last.empty() && followed.last.front().track != 0);
  });
}

}  // namespace

std::string consistency_table(const std::vector<Followed>& all) {
  Rows rows{
      {"tracker", "steps", "NIS/expected (95 %)", "correlation (95 %)", "missing", "repeated", "gated", "failed"}};
  bool lacks_innovations = false;
  for (const Followed& followed : all) {
    const TrackerCounts& counts = followed.counts;
    lacks_innovations |= followed.records > 0 && followed.innovations.steps() == 0;
    rows.push_back({followed.name, fmt::format("{}", followed.records), nis_of(followed.innovations),
                    correlation_of(followed.innovations), fmt::format("{}", counts.missing),
                    fmt::format("{}", counts.repeated), fmt::format("{}", counts.gated),
                    fmt::format("{}", counts.failed)});
    for (const auto& [sensor, innovations] : followed.of_sensors)
      rows.push_back({"  by " + sensor, fmt::format("{}", innovations.steps()), nis_of(innovations),
                      correlation_of(innovations), "", "", "", ""});
  }
  std::string text = aligned(rows);
  if (text.find(" *") != std::string::npos) text += "* outside: not as large as the tracker claims, or not white\n";
  if (lacks_innovations) text += "- of a tracker with steps: it has no innovations of its own, as corrections\n";
  return text;
}

std::vector<std::string> consistency_warnings(const std::vector<Followed>& all) {
  std::vector<std::string> lines;
  for (const Followed& followed : all) {
    const InnovationConsistency& c = followed.innovations;
    if (c.is_far_too_large_at_start())
      lines.push_back(fmt::format(
          "{}: the first innovations are far larger than it claims: is a column in another unit?", followed.name));
    if (c.is_far_too_small())
      lines.push_back(
          fmt::format("{}: innovations are far smaller than it claims: is the sensor stuck, are its measurements "
                      "smoothed, or is a sigma too large?",
                      followed.name));
  }
  return lines;
}

std::string estimate_table(const std::vector<Followed>& all) {
  const std::vector<std::string> components = components_of(all);
  if (components.empty()) return {};
  const bool several = has_several_tracks(all);
  Rows rows{{"last estimate", "time s"}};
  if (several) rows[0].push_back("track");
  for (const std::string& component : components) rows[0].push_back(shown(component).title);
  rows[0].push_back("status");
  for (const Followed& followed : all)
    for (const StepRecord& record : followed.last) {
      rows.push_back({followed.name, whole_or_decimal(record.time_s)});
      if (several) rows.back().push_back(fmt::format("{}", record.track));
      for (const std::string& component : components) rows.back().push_back(component_of(record, component));
      rows.back().push_back(std::string(to_string(record.status)));
    }
  return aligned(rows);
}

std::string event_table(const std::vector<Followed>& all) {
  Rows rows{{"tracker", "time s", "event", "value"}};
  for (const Followed& followed : all)
    for (const TrackEvent& event : followed.events)
      rows.push_back({followed.name, whole_or_decimal(event.time_s), std::string(to_string(event.kind)),
                      std::isfinite(event.value) ? whole_or_decimal(event.value) : ""});
  return rows.size() > 1 ? aligned(rows) : "";
}

}  // namespace truebearing
