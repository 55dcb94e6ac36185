// SPDX-License-Identifier: Apache-2.0
// Snapshot logs made of bytes, read in this process: what libhdf5 does not survive is for the child (io/hdf5_server.hpp),
// and what a thousand children a second would not reach is for these two.
#pragma once

#include <cstdint>
#include <span>

namespace truebearing::testing {

/// Makes a file in memory, whose datasets may be of any shape, type, layout and attributes or be none, and reads it by
/// what the child answers of it. Throws InputError where it is refused, std::logic_error where what was read is no
/// recording.
void read_made_snapshots(std::span<const std::uint8_t> bytes);

/// The bytes alter what the child answers of an ordinary file. Throws as above.
void read_answered_snapshots(std::span<const std::uint8_t> bytes);

}  // namespace truebearing::testing
