// SPDX-License-Identifier: Apache-2.0
#include "truebearing/recording/debrief_replay.hpp"

#include <algorithm>
#include <cmath>
#include <Eigen/Core>
#include <fmt/format.h>
#include <GeographicLib/LocalCartesian.hpp>
#include <GeographicLib/Math.hpp>
#include <map>
#include <optional>
#include <vector>

#include "truebearing/core/angle.hpp"
#include "truebearing/core/error.hpp"
#include "truebearing/core/printable.hpp"
#include "truebearing/io/csv.hpp"
#include "truebearing/recording/debrief_lines.hpp"

namespace truebearing {
namespace {

using Row = std::pair<std::size_t, DebriefLine>;  // with the number of its line

// East and North, in knots.
Eigen::Vector2d velocity_of(const DebriefFix& fix) {
  return fix.speed_kn * Eigen::Vector2d(std::sin(radians(fix.course_deg)), std::cos(radians(fix.course_deg)));
}

// From the vessel's positions before and after: its velocity, and its place where the line does not tell one.
void complete(DebriefFix& from, const std::vector<DebriefFix>& fixes) {
  const auto after = std::lower_bound(fixes.begin(), fixes.end(), from.time_s,
                                      [](const DebriefFix& fix, double time_s) { return fix.time_s < time_s; });
  if (after == fixes.end() || (after == fixes.begin() && after->time_s != from.time_s)) return;
  const DebriefFix &b = *after, &a = after == fixes.begin() ? b : *(after - 1);
  const double share = b.time_s > a.time_s ? (from.time_s - a.time_s) / (b.time_s - a.time_s) : 1.0;
  const Eigen::Vector2d velocity = velocity_of(a) + share * (velocity_of(b) - velocity_of(a));
  from.course_deg = degrees(std::atan2(velocity.x(), velocity.y()));
  from.speed_kn = velocity.norm();
  if (!std::isnan(from.latitude_deg)) return;
  from.latitude_deg = a.latitude_deg + share * (b.latitude_deg - a.latitude_deg);
  from.longitude_deg = a.longitude_deg + share * GeographicLib::Math::AngDiff(a.longitude_deg, b.longitude_deg);
}

void complete(std::vector<Row>& contacts, const std::vector<Row>& positions, const std::string& name) {
  std::map<std::string, std::vector<DebriefFix>> tracks;
  for (const auto& [line, position] : positions) tracks[position.track].push_back(position.from);
  for (auto& [track, fixes] : tracks)
    std::stable_sort(fixes.begin(), fixes.end(),
                     [](const DebriefFix& a, const DebriefFix& b) { return a.time_s < b.time_s; });
  for (auto& [line, contact] : contacts) {
    const auto track = tracks.find(contact.track);
    if (track != tracks.end()) complete(contact.from, track->second);
    if (track == tracks.end() && std::isnan(contact.from.latitude_deg))
      throw InputError(fmt::format("{}:{}", name, line),
                       "is of " + as_shown(contact.track) + ", which has no positions",
                       "lines of its positions, or the sensor's own place in place of NULL");
  }
}

// A row for each line of the file: empty ones where a line is none of these.
template <typename Write>
std::string table_of(const std::vector<Row>& rows, const std::vector<std::string>& header, const Write& write) {
  CsvWriter csv(header);
  std::string text = csv.take();
  std::size_t next = 1;
  for (const auto& [line, what] : rows) {
    text.append(line - next, '\n');
    next = line + 1;
    csv.number(what.from.time_s);
    csv.text(what.track);
    write(what, csv);
    csv.end_row();
    text += csv.take();
  }
  return text;
}

std::string table_of_positions(const std::vector<Row>& positions) {
  return table_of(positions, {"time_s", "track", "latitude_deg", "longitude_deg", "speed_kn", "course_deg"},
                  [](const DebriefLine& position, CsvWriter& csv) {
                    const DebriefFix& fix = position.from;
                    for (const double x : {fix.latitude_deg, fix.longitude_deg, fix.speed_kn, fix.course_deg})
                      csv.number(x);
                  });
}

// The local frame about the first place that is known.
std::optional<GeographicLib::LocalCartesian> frame_of(const std::vector<Row>& contacts) {
  for (const auto& [line, contact] : contacts)
    if (!std::isnan(contact.from.latitude_deg))
      return GeographicLib::LocalCartesian(contact.from.latitude_deg, contact.from.longitude_deg);
  return std::nullopt;
}

// A fix in the frame: [east, north, v_east, v_north] in m and kn, and how far its North is turned from the frame's.
struct InFrame {
  Eigen::Vector4d state = Eigen::Vector4d::Constant(kNaN);
  double turned_deg = 0.0;

  InFrame(const DebriefFix& fix, const std::optional<GeographicLib::LocalCartesian>& frame) {
    if (std::isnan(fix.latitude_deg)) return;
    std::vector<double> M(9);  // from East, North and up there to those of the frame, row by row
    double up_m = 0.0;
    frame->Forward(fix.latitude_deg, fix.longitude_deg, 0.0, state[0], state[1], up_m, M);
    state.tail<2>() = Eigen::Matrix2d{{M[0], M[1]}, {M[3], M[4]}} * velocity_of(fix);
    turned_deg = degrees(std::atan2(M[1], M[4]));
  }
};

std::string table_of_contacts(const std::vector<Row>& contacts) {
  const auto any = [&](auto has) { return std::any_of(contacts.begin(), contacts.end(), has); };
  const bool heard = any([](const Row& row) { return !std::isnan(row.second.frequency_hz); });
  const bool ranged = any([](const Row& row) { return !std::isnan(row.second.range_yd); });
  // Where one lacks the velocity of its place, bearings and ranges do without; a frequency cannot.
  const bool moves = any([](const Row& row) { return !std::isnan(row.second.from.speed_kn); }) &&
                     (heard || !any([](const Row& row) {
                        return !std::isnan(row.second.from.latitude_deg) && std::isnan(row.second.from.speed_kn);
                      }));
  const bool accurate = !ranged && !any([&](const Row& row) {
    return std::isnan(row.second.bearing_sigma_deg) || (heard && std::isnan(row.second.frequency_sigma_hz));
  });
  std::vector<std::pair<const char*, double DebriefLine::*>> columns;
  if (heard) columns.emplace_back("frequency_hz", &DebriefLine::frequency_hz);
  if (ranged) columns.emplace_back("range_yd", &DebriefLine::range_yd);
  if (accurate) columns.emplace_back("bearing_sigma_deg", &DebriefLine::bearing_sigma_deg);
  if (accurate && heard) columns.emplace_back("frequency_sigma_hz", &DebriefLine::frequency_sigma_hz);
  std::vector<std::string> header{"time_s", "track", "sensor", "bearing_deg"};
  for (const auto& column : columns) header.emplace_back(column.first);
  header.insert(header.end(), {"sensor_east_m", "sensor_north_m"});
  if (moves) header.insert(header.end(), {"sensor_east_kn", "sensor_north_kn"});
  const auto frame = frame_of(contacts);
  return table_of(contacts, header, [&](const DebriefLine& contact, CsvWriter& csv) {
    const InFrame from(contact.from, frame);
    csv.text(contact.sensor);
    csv.number(contact.bearing_deg + from.turned_deg);
    for (const auto& column : columns) csv.number(contact.*column.second);
    for (int i = 0; i < (moves ? 4 : 2); ++i) csv.number(from.state[i]);
  });
}

}  // namespace

bool is_debrief_replay(const std::filesystem::path& path) {
  std::string ending = path.extension().string();
  for (char& c : ending) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return ending == ".rep";
}

std::string table_of_debrief_replay(std::istream& stream, const std::string& name) {
  DebriefLines lines = read_debrief_lines(stream, name);
  if (lines.contacts.empty()) return table_of_positions(lines.positions);
  complete(lines.contacts, lines.positions, name);
  return table_of_contacts(lines.contacts);
}

}  // namespace truebearing
