// SPDX-License-Identifier: Apache-2.0
// TableReader: a TOML table read key by key. It remembers which keys were asked for; finish() turns every other key
// into an error that suggests the nearest valid one. Errors name file, line and key.
#pragma once

#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "truebearing/core/error.hpp"
#include "truebearing/io/toml_forward.hpp"

namespace truebearing {

/// The range a number must lie in; ends are valid unless `open`.
struct Range {
  double low;
  double high;
  bool open_low = false;
};
inline constexpr Range kAnyNumber{-1e300, 1e300};
inline constexpr Range kPositive{0.0, 1e300, true};
inline constexpr Range kNonNegative{0.0, 1e300};

/// Reads a TOML file of at most 1 MiB and nesting depth 64. Throws InputError with file and line.
SharedTable read_toml_file(const std::filesystem::path& path);
/// The same for text; `name` stands for the file in messages.
SharedTable parse_toml(std::string_view text, const std::string& name);

class TableReader {
 public:
  /// `file` and `path` are what messages call the table: "study.toml", "trackers.plain". `own`: what it says itself,
  /// where the rest is taken over from another, of which it need not use everything.
  TableReader(SharedTable table, std::string file, std::string path = {}, SharedTable own = nullptr);

  bool has(const std::string& key);
  /// Which of two keys the table has; an error where it has neither or both.
  std::string one_of(const std::string& a, const std::string& b);

  double number(const std::string& key, Range range = kAnyNumber);
  double number_or(const std::string& key, double fallback, Range range = kAnyNumber);
  std::int64_t integer(const std::string& key, std::int64_t low, std::int64_t high);
  std::int64_t integer_or(const std::string& key, std::int64_t fallback, std::int64_t low, std::int64_t high);
  bool boolean_or(const std::string& key, bool fallback);
  std::string text(const std::string& key);
  std::string text_or(const std::string& key, std::string fallback);
  /// One of the given names.
  std::string choice(const std::string& key, const std::vector<std::string>& valid);
  std::string choice_or(const std::string& key, const std::vector<std::string>& valid, std::string fallback);
  /// An array of `size` numbers; any number of them where size is negative. A lone number counts as one.
  std::vector<double> numbers(const std::string& key, int size = -1, Range range = kAnyNumber);
  std::vector<std::string> texts(const std::string& key);

  /// A sub-table; an error where it is missing.
  TableReader table(const std::string& key);
  std::optional<TableReader> table_if_present(const std::string& key);
  /// An array of tables; empty where the key is absent.
  std::vector<TableReader> tables(const std::string& key);
  /// The value of any type, or nullptr: for keys that may be of several types. Counts as asked for.
  const toml::node* node(const std::string& key);
  /// Names of all keys in this table, in the order of the file; does not count as asking for them.
  std::vector<std::string> keys() const;

  /// Throws on the first key that nobody asked for and that was not taken over.
  void finish() const;

  /// What messages call this table or one of its keys: "study.toml:12: trackers.plain.q".
  std::string where(const std::string& key = {}) const;
  /// An error about that, to throw.
  InputError error(const std::string& key, const std::string& found, const std::string& valid = {}) const;

  const SharedTable& raw() const { return table_; }
  const SharedTable& own() const { return own_; }
  const std::string& file() const { return file_; }
  const std::string& path() const { return path_; }
  /// Paths in a file are relative to the folder of that file.
  std::filesystem::path resolve(const std::string& relative) const;

 private:
  /// valid: what an error says would be.
  const toml::node& required(const std::string& key, const std::string& valid);
  std::string mistyped(const std::vector<std::string>& wanted) const;
  /// index: where the key holds an array of tables.
  TableReader inside(const std::string& key, const toml::table& table, std::string path, std::size_t index = 0) const;
  SharedTable own_inside(const std::string& key, std::size_t index) const;

  SharedTable table_;
  SharedTable own_;
  std::string file_;
  std::string path_;
  std::set<std::string> asked_;
};

}  // namespace truebearing
