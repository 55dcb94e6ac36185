// SPDX-License-Identifier: Apache-2.0
// Words that the streams of a run take in place of those that their generator gives. Whoever changes the randomness of
// a run a little (evaluation/run_words.hpp) needs to know nothing of what draws from it.
#pragma once

#include <array>
#include <cstdint>

namespace truebearing {

using RandomBlock = std::array<std::uint64_t, 4>;

/// What tells one stream from another: its key and its run.
struct RandomStreamName {
  std::array<std::uint64_t, 2> key;
  std::uint64_t run;

  friend bool operator==(const RandomStreamName&, const RandomStreamName&) = default;
};

class RandomSource {
 public:
  virtual ~RandomSource() = default;
  /// Block `number` of a stream, from 0 and none left out, whose generator has given `generated`. A stream that is
  /// begun again asks again. Streams that this itself draws from are the generator's.
  virtual RandomBlock block(const RandomStreamName& stream, std::uint64_t number, const RandomBlock& generated) = 0;
  /// Word `first` of a stream, counted from 0, and the one behind it are about to become two normals
  /// (RandomStream::normal()).
  virtual void normals(const RandomStreamName& stream, std::uint64_t first) = 0;
};

/// While it lives, the streams of this thread take their words from there.
class TakeRandomFrom {
 public:
  explicit TakeRandomFrom(RandomSource& source);
  ~TakeRandomFrom();
  TakeRandomFrom(const TakeRandomFrom&) = delete;
  TakeRandomFrom& operator=(const TakeRandomFrom&) = delete;

 private:
  RandomSource* before_;
};

}  // namespace truebearing
