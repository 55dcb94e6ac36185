// SPDX-License-Identifier: Apache-2.0
#include "truebearing/recording/debrief_lines.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <fmt/format.h>
#include <optional>
#include <string_view>

#include "truebearing/core/error.hpp"
#include "truebearing/core/printable.hpp"
#include "truebearing/io/iso_time.hpp"

namespace truebearing {
namespace {

// The words of a line, one after the other; what stands in quotes is one.
class Words {
 public:
  Words(std::string_view line, std::string where) : rest_(line), where_(std::move(where)) {}

  std::string_view next() {
    rest_.remove_prefix(std::min(rest_.find_first_not_of(" \t\r"), rest_.size()));
    const bool is_quoted = rest_.starts_with('"');
    if (is_quoted) rest_.remove_prefix(1);
    const std::string_view word = rest_.substr(0, rest_.find_first_of(is_quoted ? "\"" : " \t\r"));
    rest_.remove_prefix(std::min(word.size() + (is_quoted ? 1 : 0), rest_.size()));
    return word;
  }
  bool skip_null() {
    Words ahead = *this;
    const std::string_view word = ahead.next();
    const bool is_null = word == "NULL" || word == "NAN" || word == "NaN";
    if (is_null) *this = ahead;
    return is_null;
  }
  InputError error(std::string_view word, const char* what, const std::string& valid) const {
    return {where_,
            word.empty() ? fmt::format("ends before its {}", what)
                         : fmt::format("has {} for its {}", as_shown(std::string(word)), what),
            valid};
  }
  double number(const char* what, double least, double most) {
    const std::string_view word = next();
    double value = kNaN;
    const auto [end, status] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (status != std::errc() || end != word.data() + word.size() || !(value >= least && value <= most))
      throw error(word, what, fmt::format("a number in [{:g}, {:g}]", least, most));
    return value;
  }
  double number_or_null(const char* what, double least, double most) {
    return skip_null() ? kNaN : number(what, least, most);
  }
  double time_s() {
    const std::string date(next()), time(next());
    const char* century = date.size() != 6 ? "" : date < "69" ? "20" : "19";
    const std::optional<double> seconds = seconds_of_iso_time(fmt::format("{}{}T{}Z", century, date, time));
    if (!seconds) throw error(date + " " + time, "time", "YYMMDD HHMMSS.SSS");
    return *seconds;
  }
  // Degrees, minutes, seconds, and the letter of one of two hemispheres.
  double angle_deg(const char* what, double most, char positive, char negative) {
    constexpr double kSixty = 60.0;
    const double whole = number(what, 0.0, most), minutes = number(what, 0.0, kSixty);
    const double angle = whole + minutes / kSixty + number(what, 0.0, kSixty) / (kSixty * kSixty);
    const std::string_view side = next();
    if (side.size() != 1 || (side[0] != positive && side[0] != negative) || angle > most)
      throw error(side, what, fmt::format("DD MM SS.SS and {} or {}, at most {:g} degrees", positive, negative, most));
    return side[0] == positive ? angle : -angle;
  }
  void read_place(DebriefFix& fix) {
    fix.latitude_deg = angle_deg("latitude", 90.0, 'N', 'S');
    fix.longitude_deg = angle_deg("longitude", 180.0, 'E', 'W');
  }

 private:
  std::string_view rest_;
  std::string where_;
};

constexpr std::array<std::string_view, 3> kSensorLines{";SENSOR:", ";SENSOR2:", ";SENSOR3:"};
constexpr double kMostDeg = 360.0, kMost = 1e6;

DebriefLine read_contact(Words& words, std::size_t kind) {
  DebriefLine contact;
  contact.from.time_s = words.time_s();
  contact.track = words.next();
  words.next();  // the symbol
  if (!words.skip_null()) words.read_place(contact.from);
  contact.bearing_deg = words.number_or_null("bearing", -kMostDeg, kMostDeg);
  if (kind == 1) words.number_or_null("ambiguous bearing", -kMostDeg, kMostDeg);
  if (kind == 2) contact.bearing_sigma_deg = words.number_or_null("bearing accuracy", 0.0, kMostDeg);
  if (kind >= 1) contact.frequency_hz = words.number_or_null("frequency", 0.0, kMost);
  if (kind == 2) contact.frequency_sigma_hz = words.number_or_null("frequency accuracy", 0.0, kMost);
  // An accuracy of 0 states none.
  for (double* sigma : {&contact.bearing_sigma_deg, &contact.frequency_sigma_hz})
    if (*sigma == 0.0) *sigma = kNaN;
  contact.range_yd = words.number_or_null("range", 0.0, kMost);
  contact.sensor = words.next();
  return contact;
}

}  // namespace

DebriefLines read_debrief_lines(std::istream& stream, const std::string& name) {
  DebriefLines lines;
  std::string line;
  for (std::size_t number = 1; std::getline(stream, line); ++number) {
    Words words(line, fmt::format("{}:{}", name, number)), first = words;
    const std::string_view start = first.next();
    const auto kind = std::find(kSensorLines.begin(), kSensorLines.end(), start);
    if (kind != kSensorLines.end()) {
      lines.contacts.emplace_back(number, read_contact(first, static_cast<std::size_t>(kind - kSensorLines.begin())));
    } else if (!start.empty() && start[0] != ';') {
      DebriefLine position;
      position.from.time_s = words.time_s();
      position.track = words.next();
      words.next();  // the symbol
      words.read_place(position.from);
      position.from.course_deg = words.number("course", -kMostDeg, kMostDeg);
      position.from.speed_kn = words.number("speed", 0.0, kMost);
      lines.positions.emplace_back(number, position);
    }
  }
  return lines;
}

}  // namespace truebearing
