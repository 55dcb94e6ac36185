// SPDX-License-Identifier: Apache-2.0
// Several recordings, which need not be of one length, taken step by step by the copies of a pack.
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

#include "truebearing/recording/recording.hpp"

namespace truebearing {

/// Recording i by copy i of the pack, an EnsemblePack or a TrackerSetPack; taken(i, step) after each step of it. The copies
/// have been reset.
template <typename Pack, typename Taken>
void step_through(Pack& pack, std::span<const Recording* const> recordings, const Taken& taken) {
  std::size_t steps = 0;
  for (const Recording* recording : recordings) steps = std::max(steps, recording->measurements.size());
  std::vector<const Measurement*> measurements(pack.size());
  for (std::size_t step = 0; step < steps; ++step) {
    for (std::size_t i = 0; i < recordings.size(); ++i)
      measurements[i] = step < recordings[i]->measurements.size() ? &recordings[i]->measurements[step] : nullptr;
    pack.step(measurements);
    for (std::size_t i = 0; i < recordings.size(); ++i)
      if (measurements[i]) taken(i, step);
  }
}

}  // namespace truebearing
