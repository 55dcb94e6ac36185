// SPDX-License-Identifier: Apache-2.0
// Debrief's replay files (.rep) as measurement logs. A line is a position of a vessel,
//     YYMMDD HHMMSS.SSS TRACK SYMBOL DD MM SS.SS N DDD MM SS.SS E COURSE SPEED DEPTH     degrees, knots, metres
// or what a sensor of it measured, at a place of its own or, where that is NULL, at its vessel's,
//     ;SENSOR:  time TRACK SYMBOL place BEARING RANGE                                    degrees, yards
//     ;SENSOR2: time TRACK SYMBOL place BEARING AMBIGUOUS FREQUENCY RANGE                Hz
//     ;SENSOR3: time TRACK SYMBOL place BEARING ACCURACY FREQUENCY ACCURACY RANGE
// with the sensor's name and a label behind it; NULL stands for no value. Years may have four digits, names quotes. All
// other lines that begin with ; are passed over, and so are depths and ambiguous bearings.
// Source: Debrief's user guide, "Replay file format".
#pragma once

#include <filesystem>
#include <istream>
#include <string>

namespace truebearing {

/// By its ending, .rep in any case.
bool is_debrief_replay(const std::filesystem::path& path);

/// The table of what the sensors measured, line k of it after the header for line k of the file: the time (of 1969 to 2068
/// where a year has two digits), the vessel as `track`, the sensor, bearing, frequency and range where any line has one,
/// accuracies as standard deviations where every line has one and none a range, and own ship's place and velocity, from
/// the positions before and after. East and North are those of a local frame (WGS-84) about the first of these places,
/// and bearings are turned to its North. What was measured when the vessel's positions had not begun or had ended is from
/// an unknown place. Of a file without sensors the table of the positions (geographic_track.hpp).
/// Throws InputError that names `name` and the line.
std::string table_of_debrief_replay(std::istream& stream, const std::string& name);

}  // namespace truebearing
