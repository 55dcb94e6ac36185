// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <fmt/format.h>
#include <string_view>

#include "truebearing/core/bounded.hpp"
#include "truebearing/core/printable.hpp"
#include "truebearing/core/suggestion.hpp"
#include "truebearing/recording/known_columns.hpp"
#include "truebearing/recording/log_columns.hpp"
#include "truebearing/recording/log_units.hpp"

namespace truebearing {
namespace {

constexpr std::string_view kSourceColumn = "sensor";
constexpr std::string_view kTruthPrefix = "truth_", kSigmaEnd = "_sigma";

std::size_t position_in(const std::vector<std::string>& names, std::string_view name) {
  return static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin());
}

bool contains(const std::vector<std::string>& names, std::string_view name) {
  return position_in(names, name) < names.size();
}

// Builds a layout in passes over the header, in which later ones need what earlier ones found.
class LayoutReader {
 public:
  LayoutReader(const CsvReader& csv, const TimeColumn& time, const RecordingOptions& options)
      : csv_(csv), options_(options) {
    layout_.target = find_target_column(csv, options);
    for (std::size_t index = 0; index < csv.header().size(); ++index) {
      LogColumn column;
      column.index = index;
      if (index == time.index())
        column = {index, ColumnRole::time, "time_s"};
      else if (index == layout_.target)
        column = {index, ColumnRole::target, "target"};
      else if (!options.sources.empty() && csv.header()[index] == kSourceColumn)
        column = source_column(index);
      else if (!is_unwanted(csv.header()[index], options))
        name_column(column);
      layout_.columns.push_back(std::move(column));
    }
    choose_measured();
    match_sigmas();
    layout_.sensor = belonging_together(ColumnRole::sensor, "own-ship",
                                        {"sensor_east_m", "sensor_north_m", "sensor_east_mps", "sensor_north_mps"});
    find_sensor_height();
    layout_.guess =
        belonging_together(ColumnRole::guess, "guess",
                           {"guess_range_m", "guess_range_sigma_m", "guess_speed_mps", "guess_speed_sigma_mps"});
    find_truth();
    look_for_misspelt();
    check_measured_count();
  }

  LogLayout layout() && { return std::move(layout_); }

 private:
  LogColumn source_column(std::size_t index) {
    layout_.source = index;
    return {index, ColumnRole::source, std::string(kSourceColumn)};
  }

  void fault(std::size_t index, const std::string& found, const std::string& valid) {
    layout_.faults.emplace_back(csv_.name() + ": " + shortened(csv_.header()[index], 40), found, valid);
  }

  // By the name alone; a name of its own in a known unit is one of what may be measured.
  void name_column(LogColumn& column) {
    const std::string& header = csv_.header()[column.index];
    const bool is_truth = header.starts_with(kTruthPrefix);
    NameAndUnit name = apart(std::string_view(header).substr(is_truth ? kTruthPrefix.size() : 0));
    if (!name.unit) {
      if (name_without_unit(header, column)) return;
      if (is_truth) {
        const std::string meant = meant_name(csv_, column.index, truth_names());
        fault(column.index, "names no known unit",
              fmt::format("a name that ends in {}; --columns {}={} gives it one", all_suffixes(), header,
                          meant.empty() ? "truth_east_m" : meant));
      }
      return;
    }
    if (name.unit->dimension == Dimension::time) return;
    name_altitude(name, is_truth);
    column.factor = name.unit->factor;
    column.quantity = name_here(name);
    column.role = ColumnRole::measured;
    if (is_truth) {
      column.role = ColumnRole::truth;
      column.quantity = name.standard_name();
    } else if (const KnownColumn* known = find_known(name)) {
      column.role = known->role;
    } else if (name.stem.ends_with(kSigmaEnd) && name.stem != kSigmaEnd) {
      name.stem.remove_suffix(kSigmaEnd.size());
      column.role = ColumnRole::sigma;
      column.quantity = sigma_name(name_here(name));
    }
  }

  // An altitude is what is up where that is wanted, and in a truth; else it stands beside what is measured.
  void name_altitude(NameAndUnit& name, bool is_truth) const {
    if (!is_truth && !contains(options_.measured, "up_m")) return;
    if (name.stem == "altitude") name.stem = "up";
    if (name.stem == "altitude_sigma") name.stem = "up_sigma";
  }

  // The components of the Lorenz attractor, which have no unit.
  static bool name_without_unit(const std::string& header, LogColumn& column) {
    for (const std::string& component : lorenz_space().components) {
      if (header == component) column.role = ColumnRole::measured;
      if (header == kTruthPrefix.data() + component) column.role = ColumnRole::truth;
      if (header == sigma_name(component)) column.role = ColumnRole::sigma;
      if (column.role == ColumnRole::left_out) continue;
      column.factor = 1.0;
      column.quantity = column.role == ColumnRole::sigma ? header : component;
      return true;
    }
    return false;
  }

  std::vector<std::size_t> columns_of(ColumnRole role) const {
    std::vector<std::size_t> indices;
    for (const LogColumn& column : layout_.columns)
      if (column.role == role) indices.push_back(column.index);
    return indices;
  }

  /// The column of that role and quantity; a fault where there are two, in two units.
  const LogColumn* column_of(ColumnRole role, const std::string& quantity) {
    const LogColumn* found = nullptr;
    for (const LogColumn& column : layout_.columns) {
      if (column.role != role || column.quantity != quantity) continue;
      if (found) fault(column.index, "says the same as " + as_shown(csv_.header()[found->index]), "one of them");
      if (!found) found = &column;
    }
    return found;
  }

  // What is wanted, in its order, where the log has any of it; else what is known; else all that has a unit.
  void choose_measured() {
    const std::vector<std::size_t> candidates = columns_of(ColumnRole::measured);
    std::vector<std::string> chosen;
    for (const std::string& wanted : options_.measured)
      for (const std::size_t index : candidates)
        if (layout_.columns[index].quantity == wanted && !contains(chosen, wanted)) chosen.push_back(wanted);
    const auto take_if = [&](const auto& is_taken) {
      for (const std::size_t index : candidates) {
        const std::string& quantity = layout_.columns[index].quantity;
        if (is_taken(quantity) && chosen.size() <= kMaxDimension && !contains(chosen, quantity))
          chosen.push_back(quantity);
      }
    };
    if (chosen.empty()) take_if([](const std::string& quantity) { return find_known(apart(quantity)) != nullptr; });
    if (chosen.empty()) take_if([](const std::string&) { return true; });
    for (const std::string& quantity : chosen) layout_.z.push_back(*column_of(ColumnRole::measured, quantity));
    for (const std::size_t index : candidates) {
      LogColumn& column = layout_.columns[index];
      if (contains(chosen, column.quantity)) continue;
      beside_.push_back(column.quantity);
      column.role = ColumnRole::left_out;
    }
    std::sort(beside_.begin(), beside_.end());
  }

  void match_sigmas() {
    std::vector<std::string> expected;
    for (const LogColumn& column : layout_.z) expected.push_back(sigma_name(column.quantity));
    bool any = false;
    for (const std::size_t index : columns_of(ColumnRole::sigma)) {
      LogColumn& column = layout_.columns[index];
      if (contains(expected, column.quantity)) {
        any = true;
        continue;
      }
      std::string measured = column.quantity;  // "depth_sigma_m" of "depth_m"
      measured.erase(measured.rfind(kSigmaEnd), kSigmaEnd.size());
      column.role = ColumnRole::left_out;
      if (!std::binary_search(beside_.begin(), beside_.end(), measured) && !expected.empty())
        fault(index, "belongs to no measured column", fmt::format("{}", fmt::join(expected, ", ")));
    }
    if (!any) return;
    for (const std::string& quantity : expected) {
      const LogColumn* column = column_of(ColumnRole::sigma, quantity);
      if (column)
        layout_.sigma.push_back(*column);
      else
        layout_.faults.emplace_back(csv_.name(), fmt::format("has no column \"{}\"", quantity),
                                    "standard deviations of all that is measured, or of nothing");
    }
  }

  // Of four quantities those that the log has: none, the first two or all.
  std::vector<LogColumn> belonging_together(ColumnRole role, const char* what,
                                            const std::array<const char*, 4>& quantities) {
    std::vector<LogColumn> columns;
    std::array<bool, 4> has{};
    for (std::size_t i = 0; i < quantities.size(); ++i)
      if (const LogColumn* column = column_of(role, quantities[i])) {
        columns.push_back(*column);
        has[i] = true;
      }
    if (!columns.empty() && !(has[0] && has[1] && has[2] == has[3]))
      layout_.faults.emplace_back(
          csv_.name(), fmt::format("has {} columns that do not belong together", what),
          fmt::format("{}, {}, and {}, {} with them", quantities[0], quantities[1], quantities[2], quantities[3]));
    return columns;
  }

  // Own ship's, and how fast it climbs: of a platform whose place, and velocity, in the plane are told.
  void find_sensor_height() {
    const auto find = [&](const char* quantity, bool belongs, const char* with) {
      const LogColumn* column = column_of(ColumnRole::sensor, quantity);
      if (column && !belongs) fault(column->index, "stands alone", with);
      return column ? std::optional(*column) : std::nullopt;
    };
    layout_.sensor_up = find("sensor_up_m", layout_.sensor.size() >= 2, "sensor_east_m, sensor_north_m with it");
    layout_.sensor_climb = find("sensor_up_mps", layout_.sensor_up && layout_.sensor.size() == 4,
                                "sensor_up_m, sensor_east_mps, sensor_north_mps with it");
  }

  // What a truth is of as a rule, with the prefix.
  static std::vector<std::string> truth_names() {
    std::vector<std::string> names;
    for (const StateSpace* space : {&line_space(), &space_space(), &plane_frequency_space()})
      for (const std::string& component : space->components) {
        std::string name(kTruthPrefix);
        name += component;
        if (!contains(names, name)) names.push_back(std::move(name));
      }
    return names;
  }

  // One of its own that is nearly one of those, of the same dimension, which the log lacks: "truth_eas_m".
  void look_for_misspelt_truth(const std::vector<std::string>& given) {
    for (const std::size_t index : columns_of(ColumnRole::truth)) {
      const std::string &quantity = layout_.columns[index].quantity, &header = csv_.header()[index];
      const NameAndUnit name = apart(quantity);
      if (!name.unit || contains(truth_names(), kTruthPrefix.data() + quantity)) continue;
      std::vector<std::string> lacking;
      for (const std::string& known : truth_names()) {
        const std::string component = known.substr(kTruthPrefix.size());
        if (!contains(given, component) && apart(component).unit->dimension == name.unit->dimension)
          lacking.push_back(component);
      }
      if (const std::string meant = near_miss(quantity, lacking); !meant.empty())
        fault(index, "is no known column",
              fmt::format("did you mean \"truth_{}\"? --columns {}=truth_{}, or {}= to leave it out", meant, header,
                          meant, header));
    }
  }

  void find_truth() {
    std::vector<std::string> given;
    for (const std::size_t index : columns_of(ColumnRole::truth)) {
      const std::string& quantity = layout_.columns[index].quantity;
      if (given.size() <= kMaxDimension && !contains(given, quantity)) given.push_back(quantity);
    }
    if (given.empty()) return;
    look_for_misspelt_truth(given);
    if (given.size() > kMaxDimension) {
      layout_.faults.emplace_back(csv_.name(), "has too many truth_ columns", fmt::format("at most {}", kMaxDimension));
      return;
    }
    // The smallest that has them all; a frequency alone says nothing of the plane.
    const std::vector<std::string> kFrequencyAlone{"frequency_hz"};
    for (const StateSpace* space :
         {&line_space(), &plane_space(), &plane_frequency_space(), &space_space(), &lorenz_space()}) {
      const auto known = [&](const std::string& component) { return space->component_index(component) >= 0; };
      if (!layout_.truth_space && given != kFrequencyAlone && std::all_of(given.begin(), given.end(), known))
        layout_.truth_space = space;
    }
    if (!layout_.truth_space) layout_.truth_space = &state_space_of_components(given);
    for (const std::string& component : layout_.truth_space->components) {
      const LogColumn* column = column_of(ColumnRole::truth, component);
      layout_.truth.push_back(column ? std::optional(*column) : std::nullopt);
    }
  }

  // Names of no unit and names of their own, where the log lacks what they look like.
  void look_for_misspelt() {
    std::vector<std::string> known;
    for (const KnownColumn& one : known_columns()) known.emplace_back(one.name);
    for (const std::string& wanted : options_.measured)
      if (!contains(known, wanted)) known.push_back(wanted);
    for (const LogColumn& column : layout_.z) known.push_back(sigma_name(column.quantity));
    std::erase_if(known, [&](const std::string& name) {
      return std::any_of(layout_.columns.begin(), layout_.columns.end(),
                         [&](const LogColumn& column) { return column.quantity == name; });
    });
    for (LogColumn& column : layout_.columns) {
      const std::string& header = csv_.header()[column.index];
      const bool own_name = column.role == ColumnRole::measured && !find_known(apart(header)) &&
                            !contains(options_.measured, column.quantity);
      if ((column.role != ColumnRole::left_out && !own_name) || is_unwanted(header, options_)) continue;
      std::vector<std::string> meant_here = known;
      if (own_name)
        meant_here.insert(meant_here.end(), {"latitude_deg", "longitude_deg"});  // "lat_deg" of nothing else
      if (const std::string meant = meant_name(csv_, column.index, meant_here); !meant.empty()) {
        fault(
            column.index, "is no known column",
            fmt::format("did you mean \"{}\"? --columns {}={}, or {}= to leave it out", meant, header, meant, header));
      }
    }
  }

  void check_measured_count() {
    if (!layout_.z.empty() && layout_.z.size() <= kMaxDimension) return;
    const std::vector<std::string> others = layout_.left_out(csv_);
    const std::string here = others.empty() ? "" : ", other than " + as_shown(others.front());
    layout_.faults.emplace_back(
        csv_.name(), fmt::format("has {} measured columns{}", layout_.z.size(), here),
        fmt::format("1 to {}, such as range_m, bearing_deg; units are {}", kMaxDimension, all_suffixes()));
  }

  const CsvReader& csv_;
  const RecordingOptions& options_;
  LogLayout layout_;
  std::vector<std::string> beside_;  // could be measured, and is not; sorted
};

}  // namespace

std::string sigma_name(const std::string& measured) {
  const std::size_t split = measured.rfind('_');
  return measured.substr(0, split).append(kSigmaEnd).append(measured.substr(split));
}

std::vector<std::string> LogLayout::measured() const {
  std::vector<std::string> names;
  for (const LogColumn& column : z) names.push_back(column.quantity);
  return names;
}

std::vector<std::string> LogLayout::left_out(const CsvReader& csv) const {
  std::vector<std::string> names;
  for (const LogColumn& column : columns)
    if (column.role == ColumnRole::left_out) names.push_back(csv.header()[column.index]);
  return names;
}

LogLayout read_log_layout(const CsvReader& csv, const TimeColumn& time, const RecordingOptions& options) {
  return LayoutReader(csv, time, options).layout();
}

}  // namespace truebearing
