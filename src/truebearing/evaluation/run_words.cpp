// SPDX-License-Identifier: Apache-2.0
#include "truebearing/evaluation/run_words.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <tuple>

#include "truebearing/core/angle.hpp"
#include "truebearing/core/chi_square.hpp"

namespace truebearing {
namespace {

constexpr std::size_t kBlock = std::tuple_size_v<RandomBlock>;

// A word as RandomStream::uniform() reads it, on [0, 1), and the word that it reads as u.
double uniform_of(std::uint64_t word) {
  return static_cast<double>(word >> 11) * 0x1p-53;
}
std::uint64_t word_of(double u) {
  return static_cast<std::uint64_t>(std::clamp(u, 0.0, 1.0 - 0x1p-53) * 0x1p53) << 11;
}

// A normal that keeps its distribution while it moves; and which words do.
class Mover {
 public:
  Mover(const WordMove& move, RandomStream& stream)
      : share_(move.share), beta_(move.beta), rest_(std::sqrt(1.0 - move.beta * move.beta)), stream_(stream) {}

  bool moves_next() { return share_ >= 1.0 || stream_.uniform() < share_; }
  double moved(double z) { return rest_ * z + beta_ * stream_.normal(); }
  RandomStream& stream() { return stream_; }

 private:
  double share_, beta_, rest_;
  RandomStream& stream_;
};

void move_single(std::uint64_t& word, Mover& mover) {
  const double z = mover.moved(normal_quantile(uniform_of(word) + 0x1p-54));
  word = word_of(0.5 * std::erfc(-z / std::numbers::sqrt2));
}

void move_pair(std::uint64_t& first, std::uint64_t& second, Mover& mover) {
  const double radius = std::sqrt(-2.0 * std::log1p(-uniform_of(first)));
  const double angle = 2.0 * kPi * uniform_of(second);
  const double x = mover.moved(radius * std::cos(angle)), y = mover.moved(radius * std::sin(angle));
  const double turns = std::atan2(y, x) / (2.0 * kPi);
  first = word_of(-std::expm1(-0.5 * (x * x + y * y)));
  second = word_of(turns < 0.0 ? turns + 1.0 : turns);
}

void move_all(std::vector<std::uint64_t>& words, Mover& mover) {
  enum : std::uint64_t { singles, pairs, later_pairs, ways };
  const std::uint64_t way = mover.stream().index(ways);
  // What the last word would be paired with the run has not read: it is any word.
  if (way == later_pairs) words.push_back(mover.stream().bits());
  std::size_t next = 0;
  if (way == later_pairs && mover.moves_next()) move_single(words.front(), mover);
  if (way == later_pairs) ++next;
  const std::size_t together = way == singles ? 1 : 2;
  for (; next < words.size(); next += together) {
    if (!mover.moves_next()) continue;
    if (way == singles)
      move_single(words[next], mover);
    else
      move_pair(words[next], words[next + 1], mover);
  }
}

}  // namespace

RunWords::RunWords(const RunWords& from, const WordMove& move, RandomStream& stream)
    : streams_(from.streams_), fresh_(&stream) {
  Mover mover(move, stream);
  for (Stream& moved : streams_) {
    moved.read = 0;
    move_all(moved.words, mover);
  }
}

RunWords::Stream& RunWords::stream_of(const RandomStreamName& name) {
  const auto found = std::find_if(streams_.begin(), streams_.end(), [&](const Stream& s) { return s.name == name; });
  if (found != streams_.end()) return *found;
  return streams_.emplace_back(Stream{name, {}});
}

RandomBlock RunWords::block(const RandomStreamName& name, std::uint64_t number, const RandomBlock& generated) {
  Stream& stream = stream_of(name);
  const std::size_t first = number * kBlock, end = first + kBlock;
  while (stream.words.size() < end)
    stream.words.push_back(fresh_ ? fresh_->bits() : generated[stream.words.size() - first]);
  stream.read = std::max(stream.read, end);
  RandomBlock block;
  std::copy_n(stream.words.begin() + static_cast<std::ptrdiff_t>(first), kBlock, block.begin());
  return block;
}

void RunWords::keep_what_was_read() {
  std::erase_if(streams_, [](const Stream& stream) { return stream.read == 0; });
  for (Stream& stream : streams_) stream.words.resize(stream.read);
  fresh_ = nullptr;
}

std::size_t RunWords::size() const {
  std::size_t size = 0;
  for (const Stream& stream : streams_) size += stream.words.size();
  return size;
}

}  // namespace truebearing
