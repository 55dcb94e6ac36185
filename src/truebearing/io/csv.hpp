// SPDX-License-Identifier: Apache-2.0
// CSV with a header (RFC 4180), as programs write it: cells separated by comma, semicolon or tab, whichever the header
// has most of, or by what a line `sep=;` in front of it names; decimal commas where the comma does not separate cells;
// quoted cells; LF, CRLF or CR; an optional UTF-8 byte order mark; lines that begin with # are comments. Read row by
// row, so that the size of a file does not matter; numbers are read and written without regard to the locale.
#pragma once

#include <cstddef>
#include <filesystem>
#include <istream>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "truebearing/core/error.hpp"

namespace truebearing {

class CsvReader {
 public:
  /// Opens a file, or standard input where the path is "-", and reads the header. A file of JSON lines (json_lines.hpp) is
  /// read as the table that says the same. Throws InputError, as all members do.
  explicit CsvReader(const std::filesystem::path& path);
  /// The same for a stream that outlives the reader; `name` stands for the file in messages.
  CsvReader(std::istream& stream, std::string name);
  /// The same for a table that was made of a file of another kind, whose line k became row k: its header is none of them.
  CsvReader(std::unique_ptr<std::istream> table, std::string name);

  const std::vector<std::string>& header() const { return header_; }
  char separator() const { return separator_; }
  /// Gives columns other names: pairs of what the file calls it and the new one. Throws where the file has no such
  /// column, or two would have one name.
  void rename(std::span<const std::pair<std::string, std::string>> names);
  /// Index of a column; -1 where there is none of that name.
  int column(std::string_view name) const;
  /// The same where the column must be there.
  std::size_t required_column(std::string_view name) const;

  /// Moves to the next row; false at the end. Empty lines are passed over.
  bool next();
  /// Whether next() may have to wait for who writes the rows: of those that have come all are read.
  bool may_wait() const { return stream_->rdbuf()->in_avail() <= 0; }
  std::string_view text(std::size_t column) const;
  /// The same without spaces around it.
  std::string_view word(std::size_t column) const;
  /// The cell as a number; NaN where it is empty, nan, inf or another word for "none": NA, null, None, -, ...
  double number(std::size_t column) const;
  /// The same without an error: false where the cell is no number.
  bool read_number(std::size_t column, double& value) const;

  const std::string& name() const { return name_; }
  /// The line at which the current row begins, from 1.
  std::size_t line() const { return line_; }
  /// An error about a cell of the current row, to throw.
  InputError error(std::size_t column, const std::string& found, const std::string& valid = {}) const;

 private:
  void read_header();
  std::string read_header_line();
  void index_names();
  bool read_record(std::streambuf& in);
  void skip_comments(std::streambuf& in);
  InputError line_error(const std::string& found, const std::string& valid = {}) const;

  std::unique_ptr<std::istream> file_;
  std::istream* stream_;
  std::string name_;
  std::vector<std::string> header_;
  std::vector<std::size_t> by_name_;  // columns in the order of their names
  char separator_ = ',';
  mutable char decimal_mark_ = 0;  // the file's, once a number has shown it
  std::string text_;               // the cells of the current row, one after the other
  std::vector<std::size_t> ends_;  // where each of them ends
  std::size_t line_ = 0;
  std::size_t next_line_ = 1;
};

/// Builds a CSV text; write_file_atomically() takes it from there.
class CsvWriter {
 public:
  explicit CsvWriter(const std::vector<std::string>& header);

  /// Appends a cell to the row: the shortest text that reads back as the same number; NaN as an empty cell.
  void number(double value);
  void text(std::string_view value);
  /// Throws std::logic_error where the row has not as many cells as the header.
  void end_row();

  const std::string& str() const { return csv_; }
  /// The text since the last take(), which is then forgotten: rows can be written as they come.
  std::string take() { return std::exchange(csv_, {}); }

 private:
  void separate();

  std::string csv_;
  std::size_t columns_;
  std::size_t cells_ = 0;
};

}  // namespace truebearing
