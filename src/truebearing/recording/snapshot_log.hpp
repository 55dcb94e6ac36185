// SPDX-License-Identifier: Apache-2.0
// The snapshot log: what a line array recorded, as HDF5. The dataset `snapshots` (interval, snapshot, sensor, 2) holds
// the real and imaginary parts; its attributes are
//   interval_s                         how long an interval is; its snapshots come evenly and end at its time
//   spacing_wavelengths                between neighbouring sensors; or, instead of it,
//   spacing_m, frequency_hz, sound_mps of which the last is 1500 where it is absent
//   first_time_s                       of interval 0, 0 where it is absent; the others follow every interval_s
// Beside it may stand `time_s` (interval), which then tells the times, and the truth: `truth_angle_deg` (interval,
// target), from broadside, and `truth_rate_degps` (interval, target), without which the rates are the slopes of the
// angles (velocity_truth.hpp). Degrees become radians.
//
// Angles are from broadside, in (-90, 90); a target at a positive one is heard with a phase that advances from sensor 0
// to the last, exp(j 2 pi spacing sin(angle) sensor). Conjugate data are heard as mirrored angles. Targets need not
// stand in the order of their angles.
//
// Floats or integers of any width are read, 64 bit floats are written. NaN or infinite values are missing ones. An
// interval without one snapshot of finite values is counted as missing; one identical to the one before, of the same
// time, is dropped and counted.
#pragma once

#include <filesystem>

#include "truebearing/recording/recording.hpp"

namespace truebearing {

class Hdf5Reader;

/// Whether the file is to be read as one: by the ending of its name, .h5 or .hdf5, or by what it begins with.
bool is_snapshot_log(const std::filesystem::path& path);

/// Measured is "snapshots", the truth in angle_space() with targets numbered in the order of their first angles. Throws InputError that names file,
/// dataset and attribute; before anything is allocated where there are more than 4096 sensors, a million intervals, a
/// million snapshots in one, 2 GiB of snapshots, 256 targets or ten million true states.
Recording read_snapshot_log(const std::filesystem::path& path);
Recording read_snapshot_log(const Hdf5Reader& file);

/// Reads back as the same recording, angles to rounding; the same recording gives the same bytes. The file is the old
/// or the whole new one (io/file.hpp). Throws InputError where the recording is not of one array, or too large to be
/// read back.
void write_snapshot_log(const std::filesystem::path& path, const Recording& recording);

}  // namespace truebearing
