// SPDX-License-Identifier: Apache-2.0
// The process that has an HDF5 file open: what it is asked, and what it answers. A damaged file may have made of that
// process what it likes, so that an answer is believed no more than the file.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
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
  std::uint8_t failed = 0, exists = 0;  ///< no bool, which is not any byte
  std::uint32_t rank = 0;
  std::array<std::uint64_t, kHdf5MaxRank> lengths{};
  double value = 0.0;
  std::array<char, 512> found{}, valid{};  ///< where it failed
};

static_assert(std::is_trivially_copyable_v<Hdf5Question> && std::is_trivially_copyable_v<Hdf5Answer>);

template <std::size_t N>
void copy_hdf5_text(std::string_view text, std::array<char, N>& to) {
  text.copy(to.data(), N - 1);
}

/// Whom a reader asks: the process, or in tests whoever stands in for it. Its first answer, that the file is open, comes
/// unasked.
class Hdf5Respondent {
 public:
  virtual ~Hdf5Respondent() = default;
  /// Where nobody hears it, nobody answers.
  virtual void ask(const Hdf5Question& question) = 0;
  /// The next bytes of its answers; false where no more come.
  virtual bool receive(std::span<std::byte> bytes) = 0;
  /// Why no more come: "took too long".
  virtual std::string end() = 0;
};

/// Sends the answer to a question about the file that libhdf5 has open under this number. Behind one about values come
/// these, and then an answer that all of them were there; throws InputError where they were not.
void answer_hdf5_question(std::int64_t file, const Hdf5Question& question,
                          const std::function<void(std::span<const std::byte>)>& send);

/// In the child (limited_child.hpp): answers until nobody asks. Where the file cannot be opened, or memory runs out, that
/// is its last answer.
void serve_hdf5_file(const std::string& name, Channel& channel);

}  // namespace truebearing
