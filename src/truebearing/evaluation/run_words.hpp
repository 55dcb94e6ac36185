// SPDX-License-Identifier: Apache-2.0
// All random words of one simulated run, kept, so that the run can be made again and changed a little: the state and
// the moves of a Markov chain over runs.
//
// A move changes all words so that independent uniform words stay that, and is reversible with respect to them: as
// standard normals z they move to sqrt(1 - beta^2) z + beta xi, xi standard normal (preconditioned Crank-Nicolson;
// Cotter, Roberts, Stuart and White 2013). Two words of which the run made normals are these (Box and Muller), so that
// its noises themselves move; any other word u is Phi^-1(u).
//
// A run reads as many words as it likes: those that the run before has read are moved, further ones are new, and those
// that this one does not read are forgotten. The move from one run to another is as probable as the move back where
// both make normals of the same words, as far as both read (reads_alike()). Where they need not, as where draws decide
// what is drawn, words have to be moved one by one now and then.
#pragma once

#include <cstdint>
#include <vector>

#include "truebearing/core/random.hpp"
#include "truebearing/core/random_source.hpp"

namespace truebearing {

struct WordMove {
  bool as_read = true;  ///< words that became normals as these; else one by one
  double beta = 1.0;    ///< how far, in (0, 1]; at 1 nothing is left of what they were
};

class RunWords final : public RandomSource {
 public:
  /// Those of a plain run, as its generator gives them.
  RunWords() = default;
  /// Those of `from`, which has kept what was read, moved. stream: the chain's, which must live until this has done so
  /// too.
  RunWords(const RunWords& from, const WordMove& move, RandomStream& stream);

  RandomBlock block(const RandomStreamName& stream, std::uint64_t number, const RandomBlock& generated) override;
  void normals(const RandomStreamName& stream, std::uint64_t first) override;

  /// Forgets the words that no run has read, and lets go of the chain's stream. To be called when the run is made.
  void keep_what_was_read();
  /// Did the runs make normals of the same words, as far as both read? Of runs that are made.
  bool reads_alike(const RunWords& other) const;
  /// Number of words.
  std::size_t size() const;

 private:
  struct Stream {
    RandomStreamName name;
    std::vector<std::uint64_t> words;
    std::size_t read = 0;              // of them, from the first
    std::vector<std::size_t> normals;  // the first word of each two that became normals, ascending
  };
  Stream& stream_of(const RandomStreamName& name);

  std::vector<Stream> streams_;
  RandomStream* fresh_ = nullptr;  // nullptr in a plain run
};

}  // namespace truebearing
