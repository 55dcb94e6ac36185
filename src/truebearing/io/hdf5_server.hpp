// SPDX-License-Identifier: Apache-2.0
// The process that has an HDF5 file open: what it is asked, and what it answers.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <type_traits>

#include "truebearing/io/limited_child.hpp"

namespace truebearing {

/// The most dimensions that a dataset has.
inline constexpr std::size_t kHdf5MaxRank = 32;

struct Hdf5Question {
  enum class About { file, existence, shape, stored, values, attribute };
  About about = About::file;
  std::uint64_t size = 0;  ///< of `stored` and `values`
  std::array<char, 256> dataset{}, attribute{};
};

struct Hdf5Answer {
  bool failed = false;
  bool exists = false;
  unsigned rank = 0;
  std::array<std::uint64_t, kHdf5MaxRank> lengths{};
  double value = 0.0;
  std::array<char, 512> found{}, valid{};  ///< where it failed
};

static_assert(std::is_trivially_copyable_v<Hdf5Question> && std::is_trivially_copyable_v<Hdf5Answer>);

template <std::size_t N>
void copy_hdf5_text(std::string_view text, std::array<char, N>& to) {
  text.copy(to.data(), N - 1);
}

/// In the child (limited_child.hpp): answers until nobody asks. Where the file cannot be opened, or memory runs out, that
/// is its last answer. Behind the answer about values come these, and then an answer that all of them were there.
void serve_hdf5_file(const std::string& name, Channel& channel);

}  // namespace truebearing
