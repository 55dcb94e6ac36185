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

// A normal that keeps its distribution while it moves.
class Mover {
 public:
  Mover(double beta, RandomStream& stream) : beta_(beta), rest_(std::sqrt(1.0 - beta * beta)), stream_(stream) {}

  double moved(double z) { return rest_ * z + beta_ * stream_.normal(); }

 private:
  double beta_, rest_;
  RandomStream& stream_;
};

void move_single(std::uint64_t& word, Mover& mover) {
  const double z = mover.moved(normal_quantile(std::min(uniform_of(word) + 0x1p-54, 1.0 - 0x1p-53)));
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

// normals: the first word of each two that move as one, ascending.
void move_all(std::vector<std::uint64_t>& words, const std::vector<std::size_t>& normals, Mover& mover) {
  auto two = normals.begin();
  for (std::size_t next = 0; next < words.size();) {
    two = std::lower_bound(two, normals.end(), next);
    if (two != normals.end() && *two == next) {
      move_pair(words[next], words[next + 1], mover);
      next += 2;
    } else {
      move_single(words[next], mover);
      ++next;
    }
  }
}

}  // namespace

RunWords::RunWords(const RunWords& from, const WordMove& move, RandomStream& stream)
    : streams_(from.streams_), fresh_(&stream) {
  Mover mover(move.beta, stream);
  for (Stream& moved : streams_) {
    if (!move.as_read) moved.normals.clear();
    move_all(moved.words, moved.normals, mover);
    moved.normals.clear();
    moved.read = 0;
  }
}

RunWords::Stream& RunWords::stream_of(const RandomStreamName& name) {
  const auto found = std::find_if(streams_.begin(), streams_.end(), [&](const Stream& s) { return s.name == name; });
  if (found != streams_.end()) return *found;
  return streams_.emplace_back(Stream{name, {}, 0, {}});
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

void RunWords::normals(const RandomStreamName& name, std::uint64_t first) {
  std::vector<std::size_t>& normals = stream_of(name).normals;
  const auto behind = std::lower_bound(normals.begin(), normals.end(), first);
  if (behind == normals.end() || *behind != first) normals.insert(behind, static_cast<std::size_t>(first));
}

bool RunWords::reads_alike(const RunWords& other) const {
  return std::all_of(streams_.begin(), streams_.end(), [&](const Stream& a) {
    const auto found =
        std::find_if(other.streams_.begin(), other.streams_.end(), [&](const Stream& b) { return b.name == a.name; });
    if (found == other.streams_.end()) return true;
    const std::size_t common = std::min(a.read, found->read);
    const auto of_common = [common](const Stream& stream) {
      return std::vector(stream.normals.begin(),
                         std::lower_bound(stream.normals.begin(), stream.normals.end(), common));
    };
    const std::vector<std::size_t> normals = of_common(a);
    return normals == of_common(*found) && (normals.empty() || normals.back() + 1 < common);
  });
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
