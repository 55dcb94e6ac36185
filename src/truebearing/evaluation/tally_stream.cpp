// SPDX-License-Identifier: Apache-2.0
#include "truebearing/evaluation/tally_stream.hpp"

#include <algorithm>
#include <cstring>

#include "truebearing/core/error.hpp"

namespace truebearing {
namespace {

[[noreturn]] void refuse(const std::string& what) {
  throw InputError("tally of runs", what, "one that this version wrote for the same study");
}

}  // namespace

// Least byte first, whatever the machine.
void TallyStream::put(std::uint64_t word) {
  char bytes[8];
  for (char& byte : bytes) {
    byte = static_cast<char>(word & 0xffU);
    word >>= 8U;
  }
  bytes_.append(bytes, sizeof bytes);
}

std::uint64_t TallyStream::get() {
  if (left_.size() < 8) refuse("is cut short");
  std::uint64_t word = 0;
  for (int i = 7; i >= 0; --i) word = (word << 8U) | static_cast<unsigned char>(left_[static_cast<std::size_t>(i)]);
  left_.remove_prefix(8);
  return word;
}

void TallyStream::finish() const {
  if (!left_.empty()) refuse("has more in it than the study's figures");
}

std::size_t TallyStream::length(std::size_t length) {
  if (writes_) {
    put(length);
    return length;
  }
  const std::uint64_t read = get();
  if (read > left_.size()) refuse("is cut short");
  return static_cast<std::size_t>(read);
}

void TallyStream::write(std::span<const double> values) {
  put(values.size());
  if constexpr (std::endian::native == std::endian::little) {
    bytes_.append(reinterpret_cast<const char*>(values.data()), values.size_bytes());
  } else {
    for (const double value : values) put(std::bit_cast<std::uint64_t>(value));
  }
}

std::vector<double> TallyStream::read() {
  const std::uint64_t count = get();
  if (count > left_.size() / sizeof(double)) refuse("is cut short");
  std::vector<double> values(static_cast<std::size_t>(count));
  if constexpr (std::endian::native == std::endian::little) {
    if (!values.empty()) std::memcpy(values.data(), left_.data(), values.size() * sizeof(double));
    left_.remove_prefix(values.size() * sizeof(double));
  } else {
    for (double& value : values) value = get_value();
  }
  return values;
}

std::uint64_t TallyStream::small(std::uint64_t value) {
  if (writes_) {
    for (; value >= 128; value >>= 7U) bytes_ += static_cast<char>((value & 127U) | 128U);
    bytes_ += static_cast<char>(value);
    return 0;
  }
  for (unsigned shift = 0; shift < 64; shift += 7) {
    if (left_.empty()) refuse("is cut short");
    const auto byte = static_cast<unsigned char>(left_.front());
    left_.remove_prefix(1);
    value |= static_cast<std::uint64_t>(byte & 127U) << shift;
    if (byte < 128) return value;
  }
  refuse("has a number that is too long");
}

void TallyStream::least(double& least) {
  const double other = value(least);
  if (!writes_) least = std::min(least, other);
}

void TallyStream::greatest(double& greatest) {
  const double other = value(greatest);
  if (!writes_) greatest = std::max(greatest, other);
}

void TallyStream::greatest(int& greatest) {
  const std::uint64_t other = whole(static_cast<std::uint64_t>(greatest));
  if (!writes_) greatest = std::max(greatest, static_cast<int>(other));
}

void TallyStream::any(bool& any) {
  const bool other = whole(any ? 1 : 0) != 0;
  any = any || other;
}

void TallyStream::all(bool& all) {
  const bool other = whole(all ? 1 : 0) != 0;
  if (!writes_) all = all && other;
}

void TallyStream::text(std::string& text) {
  const std::size_t size = length(text.size());
  if (writes_) {
    bytes_ += text;
  } else {
    text = left_.substr(0, size);
    left_.remove_prefix(size);
  }
}

void TallyStream::names(std::vector<std::string>& names) {
  std::vector<std::string> read = writes_ ? names : std::vector<std::string>();
  read.resize(length(names.size()));
  for (std::string& name : read) text(name);
  if (names.empty()) names = std::move(read);
}

}  // namespace truebearing
