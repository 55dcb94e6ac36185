#include "truebearing/io/csv.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>
#include <fstream>
#include <iostream>
#include <limits>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "truebearing/core/suggestion.hpp"

namespace truebearing {
namespace {

constexpr std::size_t kMaxRowBytes = std::size_t{1} << 20;
constexpr int kEnd = std::char_traits<char>::eof();

std::string_view trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

/// A cell as a message shows it: short, and without characters that would upset a terminal.
std::string as_shown(std::string_view text) {
  constexpr std::size_t kMaxShown = 40;
  std::string line(text.substr(0, kMaxShown));
  std::replace_if(
      line.begin(), line.end(), [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; }, '?');
  return '"' + line + (text.size() > kMaxShown ? "...\"" : "\"");
}

std::unique_ptr<std::istream> open_file(const std::filesystem::path& path) {
  if (path == "-") return nullptr;
  std::error_code unknown;
  if (std::filesystem::is_directory(path, unknown)) throw InputError(path.string(), "is a directory", "a CSV file");
  auto file = std::make_unique<std::ifstream>(path, std::ios::binary);
  if (!*file) throw InputError(path.string(), fmt::format("cannot be opened: {}", std::strerror(errno)));
  return file;
}

}  // namespace

CsvReader::CsvReader(const std::filesystem::path& path)
    : file_(open_file(path)),
      stream_(file_ ? file_.get() : &std::cin),
      name_(file_ ? path.string() : "standard input") {
  read_header();
}

CsvReader::CsvReader(std::istream& stream, std::string name) : stream_(&stream), name_(std::move(name)) {
  read_header();
}

InputError CsvReader::line_error(const std::string& found, const std::string& valid) const {
  return {fmt::format("{}:{}", name_, line_), found, valid};
}

InputError CsvReader::error(std::size_t column, const std::string& found, const std::string& valid) const {
  return {fmt::format("{}:{}: {}", name_, line_, header_[column]), found, valid};
}

bool CsvReader::read_record() try {
  enum class State { start, plain, quoted, closed };
  State state = State::start;
  text_.clear();
  ends_.clear();
  line_ = next_line_;
  std::streambuf& in = *stream_->rdbuf();
  for (std::size_t bytes = 0;; ++bytes) {
    const int c = in.sbumpc();
    if (bytes > kMaxRowBytes) throw line_error("is too long", fmt::format("at most {} bytes", kMaxRowBytes));
    if (c == kEnd && state == State::quoted) throw line_error("has a quote that is not closed");
    if (c == kEnd && bytes == 0) return false;
    if (c == '\n') ++next_line_;

    if (state == State::quoted) {
      if (c != '"') {
        text_.push_back(static_cast<char>(c));
      } else if (in.sgetc() == '"') {
        text_.push_back(static_cast<char>(in.sbumpc()));
      } else {
        state = State::closed;
      }
    } else if (c == '\n' || c == kEnd) {
      ends_.push_back(text_.size());
      return true;
    } else if (c == ',') {
      ends_.push_back(text_.size());
      state = State::start;
    } else if (c == '\r' && (in.sgetc() == '\n' || in.sgetc() == kEnd)) {
      continue;
    } else if (c == '"' && state == State::start) {
      state = State::quoted;
    } else if (state == State::closed) {
      throw line_error("has text after a closing quote", "a comma or the end of the line");
    } else {
      text_.push_back(static_cast<char>(c));
      state = State::plain;
    }
  }
} catch (const std::ios_base::failure&) {
  throw line_error("cannot be read");
}

void CsvReader::read_header() {
  std::streambuf& in = *stream_->rdbuf();
  if (in.sgetc() == 0xEF)
    for (const int byte : {0xEF, 0xBB, 0xBF})
      if (in.sbumpc() != byte) throw InputError(name_, "does not begin with text", "CSV with a header");
  if (!read_record()) throw InputError(name_, "is empty", "CSV with a header");
  for (std::size_t column = 0; column < ends_.size(); ++column) {
    std::string title(trimmed(text(column)));
    if (title.empty()) throw line_error(fmt::format("has no name for column {}", column + 1));
    header_.push_back(std::move(title));
  }
  std::vector<std::string> sorted = header_;
  std::sort(sorted.begin(), sorted.end());
  const auto twice = std::adjacent_find(sorted.begin(), sorted.end());
  if (twice != sorted.end()) throw line_error("names column " + as_shown(*twice) + " twice");
}

int CsvReader::column(std::string_view name) const {
  const auto found = std::find(header_.begin(), header_.end(), name);
  return found == header_.end() ? -1 : static_cast<int>(found - header_.begin());
}

std::size_t CsvReader::required_column(std::string_view name) const {
  const int found = column(name);
  if (found < 0)
    throw InputError(name_, fmt::format("has no column \"{}\"", name), "columns here: " + suggestion(name, header_));
  return static_cast<std::size_t>(found);
}

bool CsvReader::next() {
  do {
    if (!read_record()) return false;
  } while (ends_.size() == 1 && text_.empty());
  if (ends_.size() != header_.size())
    throw line_error(fmt::format("has {} cells", ends_.size()), fmt::format("{}, as the header", header_.size()));
  return true;
}

std::string_view CsvReader::text(std::size_t column) const {
  const std::size_t begin = column == 0 ? 0 : ends_[column - 1];
  return std::string_view(text_).substr(begin, ends_[column] - begin);
}

double CsvReader::number(std::size_t column) const {
  const std::string_view cell = trimmed(text(column));
  if (cell.empty()) return std::numeric_limits<double>::quiet_NaN();
  const bool plus = cell.size() > 1 && cell[0] == '+' && cell[1] != '-';  // from_chars knows no plus sign
  double value = 0.0;
  const auto [end, status] = std::from_chars(cell.data() + (plus ? 1 : 0), cell.data() + cell.size(), value);
  if (status != std::errc() || end != cell.data() + cell.size())
    throw error(column, "is " + as_shown(cell), "a number, or an empty cell where there is none");
  return std::isfinite(value) ? value : std::numeric_limits<double>::quiet_NaN();
}

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
  if (value.find_first_of(",\"\r\n") == std::string_view::npos) {
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
