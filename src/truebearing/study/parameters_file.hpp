// SPDX-License-Identifier: Apache-2.0
// The parameters file: baseline parameters that `truebearing tune` fitted, by tracker, as readable TOML that studies
// name.
//     [tuned]
//     "motion.variance" = [3.1, 0.09]
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "truebearing/io/toml_forward.hpp"

namespace truebearing {

/// Values of one tracker by the dotted path of their key in its table: "motion.variance".
using TunedValues = std::map<std::string, std::vector<double>>;

struct ParametersFile {
  std::map<std::string, TunedValues> trackers;
  std::vector<std::pair<std::string, std::string>> provenance;
};

/// Throws InputError with file and key.
ParametersFile read_parameters_file(const std::filesystem::path& path);
/// The same of its text; `name` stands for the file in messages.
ParametersFile parse_parameters(std::string_view text, const std::string& name);
std::string parameters_text(const ParametersFile& parameters);

/// The path of numbers of any sign: they are fitted by least squares, not by their logarithms.
inline constexpr const char* kMeasurementMatrix = "measurement.matrix";

/// The numbers at a dotted path of a tracker's table. Throws InputError where there are none, or one that is not > 0
/// (of the matrix above: not finite).
std::vector<double> numbers_at(const toml::table& table, const std::string& path, const std::string& where);
/// The table with these numbers there, as an array or as a lone number as it was.
SharedTable with_numbers(const toml::table& table, const std::string& path, const std::vector<double>& values);

}  // namespace truebearing
