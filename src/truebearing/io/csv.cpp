// SPDX-License-Identifier: Apache-2.0
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
#include <numeric>
#include <sstream>
#include <system_error>
#include <utility>

#include "truebearing/core/printable.hpp"
#include "truebearing/core/suggestion.hpp"
#include "truebearing/io/json_lines.hpp"

namespace truebearing {
namespace {

constexpr std::size_t kMaxRowBytes = std::size_t{1} << 20;
constexpr int kEnd = std::char_traits<char>::eof();

std::string_view trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

// What other programs write where there is no number, in small letters; "nan" and "inf" are numbers to from_chars().
constexpr std::array<std::string_view, 12> kMissing{"na",  "n/a", "#n/a", "<na>", "null", "none",
                                                    "nil", "nat", "\\n",  "-",    "--",   "."};
constexpr std::array<std::string_view, 4> kMicrosoftMissing{"1.#qnan", "1.#snan", "1.#ind", "1.#inf"};  // and zeros

bool is_word_for_missing(std::string_view cell) {
  constexpr std::size_t kLongest = 12;
  if (cell.size() > kLongest) return false;
  std::string word(cell);
  std::transform(word.begin(), word.end(), word.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  if (std::find(kMissing.begin(), kMissing.end(), word) != kMissing.end()) return true;
  const std::string_view unsigned_word = std::string_view(word).substr(word[0] == '-' || word[0] == '+' ? 1 : 0);
  return std::any_of(kMicrosoftMissing.begin(), kMicrosoftMissing.end(), [&](std::string_view form) {
    return unsigned_word.starts_with(form) && unsigned_word.find_first_not_of('0', form.size()) == unsigned_word.npos;
  });
}

// Whether a number that no double holds is smaller than all of them, and not greater.
bool is_tiny(std::string_view digits) {
  const std::size_t exponent = digits.find_first_of("eE");
  if (exponent != digits.npos && exponent + 1 < digits.size()) return digits[exponent + 1] == '-';
  return digits.find_first_of("123456789") > digits.find('.');
}

// The whole of a text without locale; a number too small for a double is 0, one too large none.
bool parse_number(std::string_view text, double& value) {
  if (text.size() > 1 && text[0] == '+' && text[1] != '-') text.remove_prefix(1);  // from_chars knows no plus sign
  const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (end != text.data() + text.size()) return false;
  if (status == std::errc::result_out_of_range && is_tiny(text)) {
    value = 0.0;
    return true;
  }
  return status == std::errc();
}

// "sep=;", which Excel takes for the separator of the lines that follow.
char named_separator(std::string_view line) {
  while (!line.empty() && (line.back() == '\n' || line.back() == '\r')) line.remove_suffix(1);
  if (line.size() > 2 && line.front() == '"' && line.back() == '"') line = line.substr(1, line.size() - 2);
  return line.size() == 5 && (line.starts_with("sep=") || line.starts_with("SEP=")) ? line[4] : '\0';
}

// Of comma, semicolon and tab the one that a header has most of outside quotes.
char frequent_separator(std::string_view header) {
  constexpr std::array kSeparators{',', ';', '\t'};
  std::array<std::size_t, kSeparators.size()> counts{};
  bool quoted = false;
  for (const char c : header) {
    quoted ^= c == '"';
    for (std::size_t i = 0; i < kSeparators.size() && !quoted; ++i) counts[i] += c == kSeparators[i];
  }
  return kSeparators[static_cast<std::size_t>(std::max_element(counts.begin(), counts.end()) - counts.begin())];
}

std::string name_of(char separator) {
  return separator == ',' ? "a comma" : separator == '\t' ? "a tab" : fmt::format("'{}'", separator);
}

std::unique_ptr<std::istream> open_file(const std::filesystem::path& path) {
  if (path == "-") return nullptr;
  std::error_code unknown;
  if (std::filesystem::is_directory(path, unknown)) throw InputError(path.string(), "is a directory", "a CSV file");
  auto file = std::make_unique<std::ifstream>(path, std::ios::binary);
  if (!*file) throw InputError(path.string(), fmt::format("cannot be opened: {}", std::strerror(errno)));
  if (is_json_lines(path)) return std::make_unique<std::istringstream>(csv_of_json_lines(*file, path.string()));
  return file;
}

}  // namespace

CsvReader::CsvReader(const std::filesystem::path& path)
    : file_(open_file(path)),
      stream_(file_ ? file_.get() : &std::cin),
      name_(file_ ? path.string() : "standard input"),
      next_line_(is_json_lines(path) ? 0 : 1) {  // whose first line is a row
  read_header();
}

CsvReader::CsvReader(std::istream& stream, std::string name) : stream_(&stream), name_(std::move(name)) {
  read_header();
}

CsvReader::CsvReader(std::unique_ptr<std::istream> table, std::string name)
    : file_(std::move(table)), stream_(file_.get()), name_(std::move(name)), next_line_(0) {
  read_header();
}

InputError CsvReader::line_error(const std::string& found, const std::string& valid) const {
  return {fmt::format("{}:{}", name_, line_), found, valid};
}

InputError CsvReader::error(std::size_t column, const std::string& found, const std::string& valid) const {
  constexpr std::size_t kMostOfName = 40;
  return {fmt::format("{}:{}: {}", name_, line_, shortened(header_[column], kMostOfName)), found, valid};
}

void CsvReader::skip_comments(std::streambuf& in) {
  while (in.sgetc() == '#') {
    for (int c = in.sbumpc(); c != kEnd && c != '\n'; c = in.sbumpc())
      if (c == '\r' && in.sgetc() != '\n') break;
    ++next_line_;
  }
}

bool CsvReader::read_record(std::streambuf& in) try {
  enum class State { start, plain, quoted, closed };
  State state = State::start;
  text_.clear();
  ends_.clear();
  skip_comments(in);
  line_ = next_line_;
  for (std::size_t bytes = 0;; ++bytes) {
    int c = in.sbumpc();
    if (bytes > kMaxRowBytes) throw line_error("is too long", fmt::format("at most {} bytes", kMaxRowBytes));
    if (c == kEnd && state == State::quoted) throw line_error("has a quote that is not closed");
    if (c == kEnd && bytes == 0) return false;
    if (c == 0) throw line_error("holds a zero byte, which is no text", "UTF-8, as `iconv -t UTF-8` writes it");
    if (c == '\r' && state != State::quoted) {  // alone, or of CRLF
      if (in.sgetc() == '\n') in.sbumpc();
      c = '\n';
    }
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
    } else if (c == static_cast<unsigned char>(separator_)) {
      ends_.push_back(text_.size());
      state = State::start;
    } else if (c == '"' && state == State::start) {
      state = State::quoted;
    } else if (state == State::closed) {
      throw line_error("has text after a closing quote", name_of(separator_) + " or the end of the line");
    } else {
      text_.push_back(static_cast<char>(c));
      state = State::plain;
    }
  }
} catch (const std::ios_base::failure&) {
  throw line_error("cannot be read");
}

// The next line that is not empty, with its end and quoted line ends included: what separates its cells is known only
// when it has been seen.
std::string CsvReader::read_header_line() try {
  std::streambuf& in = *stream_->rdbuf();
  while (true) {
    skip_comments(in);
    line_ = next_line_;
    std::string line;
    bool quoted = false, ended = false;
    while (!ended && in.sgetc() != kEnd) {
      const int c = in.sbumpc();
      if (line.size() > kMaxRowBytes) throw line_error("is too long", fmt::format("at most {} bytes", kMaxRowBytes));
      line.push_back(static_cast<char>(c));
      quoted ^= c == '"';
      ended = !quoted && (c == '\n' || c == '\r');
      if (ended && c == '\r' && in.sgetc() == '\n') line.push_back(static_cast<char>(in.sbumpc()));
    }
    if (!ended || line.find_first_not_of("\r\n") != line.npos) return line;
    ++next_line_;
  }
} catch (const std::ios_base::failure&) {
  throw line_error("cannot be read");
}

void CsvReader::read_header() {
  std::streambuf& in = *stream_->rdbuf();
  if (in.sgetc() == 0xFF || in.sgetc() == 0xFE)
    throw InputError(name_, "is UTF-16 text, or none", "UTF-8, as `iconv -f UTF-16 -t UTF-8` writes it");
  if (in.sgetc() == 0xEF)
    for (const int byte : {0xEF, 0xBB, 0xBF})
      if (in.sbumpc() != byte) throw InputError(name_, "does not begin with text", "CSV with a header");
  std::string line = read_header_line();
  const char named = named_separator(line);
  if (named != '\0') {
    ++next_line_;
    line = read_header_line();
  }
  if (line.empty()) throw InputError(name_, "is empty", "CSV with a header");
  separator_ = named != '\0' ? named : frequent_separator(line);
  std::stringbuf header(line);
  read_record(header);
  for (std::size_t column = 0; column < ends_.size(); ++column) {
    std::string title(word(column));
    if (title.empty()) throw line_error(fmt::format("has no name for column {}", column + 1));
    header_.push_back(std::move(title));
  }
  index_names();
}

void CsvReader::index_names() {
  by_name_.resize(header_.size());
  std::iota(by_name_.begin(), by_name_.end(), std::size_t{0});
  std::sort(by_name_.begin(), by_name_.end(), [&](std::size_t a, std::size_t b) { return header_[a] < header_[b]; });
  const auto twice = std::adjacent_find(by_name_.begin(), by_name_.end(),
                                        [&](std::size_t a, std::size_t b) { return header_[a] == header_[b]; });
  if (twice != by_name_.end())
    throw InputError(fmt::format("{}:{}", name_, line_), "names column " + as_shown(header_[*twice]) + " twice");
}

void CsvReader::rename(std::span<const std::pair<std::string, std::string>> names) {
  std::vector<std::pair<std::size_t, const std::string*>> renamed;
  for (const auto& [old_name, new_name] : names) renamed.emplace_back(required_column(old_name), &new_name);
  for (const auto& [column, new_name] : renamed) header_[column] = *new_name;
  index_names();
}

int CsvReader::column(std::string_view name) const {
  const auto found =
      std::lower_bound(by_name_.begin(), by_name_.end(), name,
                       [&](std::size_t column, std::string_view other) { return header_[column] < other; });
  return found == by_name_.end() || header_[*found] != name ? -1 : static_cast<int>(*found);
}

std::size_t CsvReader::required_column(std::string_view name) const {
  const int found = column(name);
  if (found < 0)
    throw InputError(name_, fmt::format("has no column \"{}\"", name), "columns here: " + suggestion(name, header_));
  return static_cast<std::size_t>(found);
}

bool CsvReader::next() {
  do {
    if (!read_record(*stream_->rdbuf())) return false;
  } while (ends_.size() == 1 && text_.empty());
  if (ends_.size() != header_.size())
    throw line_error(fmt::format("has {} cells", ends_.size()), fmt::format("{}, as the header", header_.size()));
  return true;
}

std::string_view CsvReader::text(std::size_t column) const {
  const std::size_t begin = column == 0 ? 0 : ends_[column - 1];
  return std::string_view(text_).substr(begin, ends_[column] - begin);
}

std::string_view CsvReader::word(std::size_t column) const {
  return trimmed(text(column));
}

bool CsvReader::read_number(std::size_t column, double& value) const {
  std::string_view cell = word(column);
  value = std::numeric_limits<double>::quiet_NaN();
  if (cell.empty()) return true;
  std::string with_point;
  const std::size_t mark = separator_ == ',' ? cell.npos : cell.find_first_of(",.");
  if (mark != cell.npos && cell[mark] == ',') {
    with_point = cell;
    with_point[mark] = '.';  // another mark after it makes it no number
    cell = with_point;
  }
  double number = 0.0;
  if (!parse_number(cell, number)) return is_word_for_missing(cell);
  if (mark != cell.npos) {
    const char decimal_mark = with_point.empty() ? '.' : ',';
    if (decimal_mark_ != 0 && decimal_mark_ != decimal_mark) return false;  // 1,234 is not 1.234 then
    decimal_mark_ = decimal_mark;
  }
  if (std::isfinite(number)) value = number;
  return true;
}

double CsvReader::number(std::size_t column) const {
  double value = 0.0;
  if (!read_number(column, value))
    throw error(column, "is " + as_shown(word(column)), "a number, or an empty cell where there is none");
  return value;
}

}  // namespace truebearing
