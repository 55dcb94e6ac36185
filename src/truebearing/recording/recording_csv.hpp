// The measurement log: CSV with `time_s`, measured columns with their units in the name (`position_m`, `bearing_deg`),
// and optionally their standard deviations (`position_sigma_m`), own-ship columns (`sensor_east_m`, `sensor_north_m`,
// and `sensor_east_mps`, `sensor_north_mps`), a guess of what is tracked (`guess_range_m`, `guess_range_sigma_m`, and
// `guess_speed_mps`, `guess_speed_sigma_mps`) and the truth (`truth_<component>`). Degrees become radians.
//
// An empty, NaN or infinite cell makes the measurement missing. A row identical to the one before is dropped. Both are
// counted. A truth that gives positions only is completed by velocity_truth().
#pragma once

#include <filesystem>
#include <istream>
#include <string>

#include "truebearing/recording/recording.hpp"

namespace truebearing {

/// Reads a log; "-" is standard input. Throws InputError that names file, line and column.
Recording read_recording(const std::filesystem::path& path);
/// The same for a stream; `name` stands for the file in messages.
Recording read_recording(std::istream& stream, const std::string& name);

/// The text of a log, which reads back as the same recording. Sigma and sensor columns are written where any
/// measurement has them. Throws InputError where there are several true tracks, which a log cannot hold.
std::string write_recording(const Recording& recording);

}  // namespace truebearing
