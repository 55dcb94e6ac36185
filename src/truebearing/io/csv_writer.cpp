// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <charconv>
#include <cmath>
#include <fmt/format.h>
#include <stdexcept>

#include "truebearing/io/csv.hpp"

namespace truebearing {

CsvWriter::CsvWriter(const std::vector<std::string>& header) : columns_(header.size()) {
  for (const std::string& name : header) text(name);
  end_row();
}

void CsvWriter::separate() {
  if (cells_++ > 0) csv_ += ',';
}

void CsvWriter::number(double value) {
  separate();
  if (std::isnan(value)) return;
  std::array<char, 32> digits;
  const auto result = std::to_chars(digits.data(), digits.data() + digits.size(), value);
  csv_.append(digits.data(), result.ptr);
}

void CsvWriter::text(std::string_view value) {
  separate();
  const bool begins_comment = cells_ == 1 && value.starts_with('#');
  if (!begins_comment && value.find_first_of(",\"\r\n") == std::string_view::npos) {
    csv_ += value;
    return;
  }
  csv_ += '"';
  for (const char c : value) csv_ += c == '"' ? std::string(2, c) : std::string(1, c);
  csv_ += '"';
}

void CsvWriter::end_row() {
  if (cells_ != columns_)
    throw std::logic_error(fmt::format("CSV row with {} cells under a header of {}", cells_, columns_));
  csv_ += '\n';
  cells_ = 0;
}

}  // namespace truebearing
