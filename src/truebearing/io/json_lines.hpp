// SPDX-License-Identifier: Apache-2.0
// JSON lines: a flat object to a line, {"time_s": 1.0, "range_m": 5000}, as loggers write them; read as the CSV table
// that says the same.
#pragma once

#include <filesystem>
#include <istream>
#include <string>

namespace truebearing {

/// By its ending: .jsonl or .ndjson.
bool is_json_lines(const std::filesystem::path& path);

/// The table with a column for each key, in the order in which keys first come, and line k + 1 for line k: cells that an
/// object has not are empty, as null is. Throws InputError that names `name` and the line where it is no flat object.
std::string csv_of_json_lines(std::istream& stream, const std::string& name);

}  // namespace truebearing
