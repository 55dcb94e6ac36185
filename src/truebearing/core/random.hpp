// SPDX-License-Identifier: Apache-2.0
// Random numbers: counter-based (Philox 4x64-10, Salmon et al. 2011), so that a stream is a pure function of its key
// and Monte Carlo runs can be computed in any order on any thread.
//
// A stream is keyed by (seed, role, run, stream). The role is part of the key, so that no choice of seeds can make
// the tuning, training, validation and evaluation draws overlap.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>

namespace truebearing {

enum class Role : std::uint32_t { tuning = 1, training = 2, validation = 3, evaluation = 4 };

/// Streams that one run draws from; each is independent of the others.
enum class StreamId : std::uint32_t {
  scenario = 1,
  process = 2,
  measurement = 3,
  learning = 4,
  test = 5,
  schedule = 6,
  particles = 7
};

/// Which Monte Carlo run: all that a simulated recording depends on besides its scenario.
struct RunKey {
  std::uint64_t seed = 1;
  Role role = Role::evaluation;
  std::uint64_t run = 0;
};

class RandomStream {
 public:
  RandomStream(const RunKey& key, StreamId stream)
      : key_{{key.seed, (static_cast<std::uint64_t>(key.role) << 32) | static_cast<std::uint64_t>(stream)}},
        counter_{{0, key.run, 0, 0}} {}

  std::uint64_t bits() {
    if (next_ == 4) refill();
    return block_[next_++];
  }

  /// Uniform on [0, 1).
  double uniform() { return static_cast<double>(bits() >> 11) * 0x1p-53; }
  /// Uniform on [low, high).
  double uniform(double low, double high) { return low + (high - low) * uniform(); }
  /// Uniform integer in [0, count), count >= 1.
  std::uint64_t index(std::uint64_t count) {
    return static_cast<std::uint64_t>(uniform() * static_cast<double>(count));
  }

  /// Standard normal (Box and Muller 1958).
  double normal() {
    if (has_spare_) {
      has_spare_ = false;
      return spare_;
    }
    if (next_ == block_.size()) refill();
    if (has_source_) tell_of_normals();
    const double radius = std::sqrt(-2.0 * std::log(1.0 - uniform()));
    const double angle = 2.0 * std::numbers::pi * uniform();
    spare_ = radius * std::sin(angle);
    has_spare_ = true;
    return radius * std::cos(angle);
  }

 private:
  /// The next block of the stream (random.cpp, which alone sees the generator).
  void refill();
  /// Where the words come from elsewhere (random_source.hpp): that the next two become normals.
  void tell_of_normals();

  std::array<std::uint64_t, 2> key_;
  std::array<std::uint64_t, 4> counter_;
  std::array<std::uint64_t, 4> block_{};
  unsigned next_ = 4;
  bool has_source_ = false;
  bool has_spare_ = false;
  double spare_ = 0.0;
};

}  // namespace truebearing
