// SPDX-License-Identifier: Apache-2.0
// TallyStream: a tally of some runs as bytes, and the same bytes added to the tally of the runs before them. A tally
// names its sums once, in exchange(), and this writes them or adds to them. So it does not matter in which thread or
// process a block of runs was computed, nor on which machine of one kind (docs/scale.md): what adds the same blocks in
// the same order has the same figures to the last bit.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <string>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

namespace truebearing {

class TallyStream {
 public:
  /// Writes. compact: of blocks of so many runs that what is kept run by run has to be taken together.
  explicit TallyStream(bool compact) : writes_(true), compact_(compact) {}
  /// Adds what another has written. The bytes must outlive it.
  explicit TallyStream(std::string_view bytes) : writes_(false), compact_(false), left_(bytes) {}

  bool writes() const { return writes_; }
  bool compact() const { return compact_; }
  const std::string& written() const& { return bytes_; }
  std::string written() && { return std::move(bytes_); }
  /// Throws InputError where bytes are left that no sum has taken.
  void finish() const;

  void sum(double& sum) { sum += value(sum); }
  void sum(long& sum) { sum += static_cast<long>(whole(static_cast<std::uint64_t>(sum))); }
  void least(double& least);
  void greatest(double& greatest);
  void greatest(int& greatest);
  void any(bool& any);
  void all(bool& all);
  /// Writes it, or replaces it.
  void text(std::string& text);
  /// Of the first that has any.
  void names(std::vector<std::string>& names);

  /// Writes the value and gives 0, or reads one.
  double value(double value) { return writes_ ? (put(std::bit_cast<std::uint64_t>(value)), 0.0) : get_value(); }
  /// Writes the length and gives it back, or reads one. Items take a byte or more each.
  std::size_t length(std::size_t length);
  std::uint64_t whole(std::uint64_t value) { return writes_ ? (put(value), 0) : get(); }

  /// The same of one that is mostly small: seven bits in a byte.
  std::uint64_t small(std::uint64_t value);

  /// A list of values that is written or read as one.
  void write(std::span<const double> values);
  std::vector<double> read();

  /// Item by item, by each(item): the list grows to the length of the one that is added.
  template <typename Item, typename Each>
  void list(std::vector<Item>& items, const Each& each) {
    const std::size_t count = length(items.size());
    for (std::size_t i = 0; i < count; ++i) {
      if (i == items.size()) items.emplace_back();  // one by one: a stream that ends early takes no memory
      each(items[i]);
    }
  }

 private:
  void put(std::uint64_t word);
  std::uint64_t get();
  double get_value() { return std::bit_cast<double>(get()); }

  bool writes_;
  bool compact_;
  std::string bytes_;
  std::string_view left_;
};

}  // namespace truebearing
