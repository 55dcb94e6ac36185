// SPDX-License-Identifier: Apache-2.0
// Everything that reads what a stranger may have written, on any bytes.
#pragma once

#include <cstdint>
#include <span>

namespace truebearing::testing {

/// The first byte says which reader: r recording, d one of Debrief's, g geographic track, s step log, t TOML, m model, w its weights,
/// p parameters, y study, h snapshots; f a file of these that is made of the rest, c what the child that reads one
/// answers (snapshot_files.hpp). True where the rest was read; where it was refused by an InputError, false. Nothing
/// else may happen.
/// Of e the rest drives a tracker (estimators.hpp): true where it published anything.
bool read_hostile(std::span<const std::uint8_t> bytes);

}  // namespace truebearing::testing
