// SPDX-License-Identifier: Apache-2.0
// The times of a recorded file: a number in the unit that the column's name ends in (`time_s`, `time_ms`,
// `timestamp_ns`), or ISO 8601 text under these or under a name without a unit (`time`, `timestamp`, `datetime`).
#pragma once

#include <cstddef>
#include <optional>

#include "truebearing/io/csv.hpp"

namespace truebearing {

class TimeColumn {
 public:
  /// Throws InputError where the header names no time.
  explicit TimeColumn(const CsvReader& csv);

  std::size_t index() const { return index_; }
  bool has_unit() const { return unit_s_.has_value(); }

  /// The current row's time in seconds: since 1970 (UTC) of text. Throws InputError where there is none, where a number
  /// has no unit, and where a column has both text and numbers.
  double read(const CsvReader& csv);

 private:
  std::size_t index_;
  std::optional<double> unit_s_;
  std::optional<bool> is_text_;  // once a row has shown it
};

}  // namespace truebearing
