// SPDX-License-Identifier: Apache-2.0
// All random words of one simulated run, kept, so that the run can be made again and changed a little: the state and the
// moves of a Markov chain over runs.
//
// A move changes a share of the words so that independent uniform words stay that, and is reversible with respect to them:
// words u as standard normals z move to sqrt(1 - beta^2) z + beta xi, xi standard normal (preconditioned Crank-Nicolson;
// Cotter, Roberts, Stuart and White 2013). What words are taken for depends on who reads a stream, which does not tell. So
// each move tosses for each stream:
//
//   singles       z = Phi^-1(u): a uniform, a drawn parameter
//   pairs         (z1, z2) = sqrt(-2 ln(1 - u1)) (cos 2 pi u2, sin 2 pi u2): what RandomStream::normal() makes of two
//                 words, so that the measurement noise itself moves; of words 0 1, 2 3 ..., or of words 1 2, 3 4 ...
//
// Which is tossed changes how well a chain mixes, not what it tends to. A run reads as many words as it likes: those that
// the run before has read are moved, further ones are new, and those that this one does not read are forgotten. The move
// from one run to another is then as probable as the move back.
#pragma once

#include <cstdint>
#include <vector>

#include "truebearing/core/random.hpp"
#include "truebearing/core/random_source.hpp"

namespace truebearing {

struct WordMove {
  double share = 1.0;  ///< of the words that move, in (0, 1]
  double beta = 1.0;   ///< how far, in (0, 1]; at 1 nothing is left of what they were
};

class RunWords final : public RandomSource {
 public:
  /// Those of a plain run, as its generator gives them.
  RunWords() = default;
  /// Those of `from`, which has kept what was read, moved. stream: the chain's, which must live until this has done so too.
  RunWords(const RunWords& from, const WordMove& move, RandomStream& stream);

  RandomBlock block(const RandomStreamName& stream, std::uint64_t number, const RandomBlock& generated) override;

  /// Forgets the words that no run has read, and lets go of the chain's stream. To be called when the run is made.
  void keep_what_was_read();
  /// Number of words.
  std::size_t size() const;

 private:
  struct Stream {
    RandomStreamName name;
    std::vector<std::uint64_t> words;
    std::size_t read = 0;  // of them, from the first
  };
  Stream& stream_of(const RandomStreamName& name);

  std::vector<Stream> streams_;
  RandomStream* fresh_ = nullptr;  // nullptr in a plain run
};

}  // namespace truebearing
