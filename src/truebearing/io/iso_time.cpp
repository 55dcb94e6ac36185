// SPDX-License-Identifier: Apache-2.0
#include "truebearing/io/iso_time.hpp"

#include <chrono>
#include <cstddef>

namespace truebearing {
namespace {

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

// Takes what it recognises from the front of the text.
class Scanner {
 public:
  explicit Scanner(std::string_view text) : text_(text) {}

  bool at_end() const { return text_.empty(); }

  bool take(char expected) {
    if (text_.empty() || text_.front() != expected) return false;
    text_.remove_prefix(1);
    return true;
  }

  /// Exactly so many digits.
  std::optional<int> number(std::size_t digits) {
    if (text_.size() < digits) return std::nullopt;
    int value = 0;
    for (const char c : text_.substr(0, digits)) {
      if (!is_digit(c)) return std::nullopt;
      value = 10 * value + (c - '0');
    }
    text_.remove_prefix(digits);
    return value;
  }

  /// The digits of a decimal fraction, as many as there are.
  std::optional<double> fraction() {
    if (text_.empty() || !is_digit(text_.front())) return std::nullopt;
    double numerator = 0.0, denominator = 1.0;
    for (int digits = 0; !text_.empty() && is_digit(text_.front()); ++digits) {
      constexpr int kMostThatCount = 15;
      if (digits < kMostThatCount) {
        numerator = 10.0 * numerator + (text_.front() - '0');
        denominator *= 10.0;
      }
      text_.remove_prefix(1);
    }
    return numerator / denominator;
  }

 private:
  std::string_view text_;
};

std::optional<std::chrono::sys_days> take_date(Scanner& text) {
  const auto year = text.number(4);
  const bool dashes = text.take('-');
  const auto month = text.number(2);
  if (dashes && !text.take('-')) return std::nullopt;
  const auto day = text.number(2);
  if (!year || !month || !day) return std::nullopt;
  const std::chrono::year_month_day date{std::chrono::year(*year), std::chrono::month(static_cast<unsigned>(*month)),
                                         std::chrono::day(static_cast<unsigned>(*day))};
  if (!date.ok()) return std::nullopt;
  return std::chrono::sys_days(date);
}

// Hours and minutes, and seconds where they are there; the 60th of a leap second is one of them.
std::optional<double> take_time_of_day(Scanner& text) {
  const auto hour = text.number(2);
  const bool colons = text.take(':');
  const auto minute = text.number(2);
  if (!hour || !minute || *hour > 23 || *minute > 59) return std::nullopt;
  double seconds = 3600.0 * *hour + 60.0 * *minute;
  if (colons && !text.take(':')) return seconds;
  const auto second = text.number(2);
  if (!second) return colons ? std::nullopt : std::optional(seconds);
  if (*second > 60) return std::nullopt;
  seconds += *second;
  if (!text.take('.') && !text.take(',')) return seconds;
  const auto fraction = text.fraction();
  if (!fraction) return std::nullopt;
  return seconds + *fraction;
}

// Of "Z", "+01:00", "-0330", "+01"; nothing of other text.
std::optional<double> take_offset(Scanner& text) {
  if (text.at_end() || text.take('Z') || text.take('z')) return 0.0;
  const bool east = text.take('+');
  if (!east && !text.take('-')) return std::nullopt;
  const auto hours = text.number(2);
  if (!hours || *hours > 23) return std::nullopt;
  const bool colon = text.take(':');
  const auto minutes = !colon && text.at_end() ? std::optional(0) : text.number(2);
  if (!minutes || *minutes > 59) return std::nullopt;
  const double seconds = 3600.0 * *hours + 60.0 * *minutes;
  return east ? seconds : -seconds;
}

}  // namespace

std::optional<double> seconds_of_iso_time(std::string_view text) {
  Scanner scanner(text);
  const auto date = take_date(scanner);
  if (!date || (!scanner.take('T') && !scanner.take('t') && !scanner.take(' '))) return std::nullopt;
  const auto time_of_day_s = take_time_of_day(scanner);
  if (!time_of_day_s) return std::nullopt;
  scanner.take(' ');  // Python writes "12:00:00 +0100"
  const auto offset_s = take_offset(scanner);
  if (!offset_s || !scanner.at_end()) return std::nullopt;
  const auto days = date->time_since_epoch().count();
  return 86400.0 * static_cast<double>(days) - *offset_s + *time_of_day_s;
}

}  // namespace truebearing
