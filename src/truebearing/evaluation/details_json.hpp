// SPDX-License-Identifier: Apache-2.0
// The details of a comparison and the pictures of its runs as JSON: what plots need, beside the results.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "truebearing/evaluation/comparison.hpp"
#include "truebearing/evaluation/run_picture.hpp"

namespace truebearing {

/// Of a longer run every n-th step.
nlohmann::ordered_json picture_json(const RunPicture& picture);

/// Adds `details` to each tracker of the results, and `pictures`; nothing where there are none. Numbers are written to
/// six digits: they are looked at.
void add_details(const Comparison& comparison, const std::vector<RunPicture>& pictures,
                 nlohmann::ordered_json& results);

}  // namespace truebearing
