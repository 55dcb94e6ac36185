// SPDX-License-Identifier: Apache-2.0
// What a correction did in a comparison, as JSON: what plots of it need.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "truebearing/evaluation/correction_details.hpp"

namespace truebearing {

/// Steps, shares outside the box, and rules and features with what the model says of them. Numbers have six digits.
nlohmann::ordered_json correction_json(const CorrectionDetails& details);
/// The same without what the model says, for one set of several.
nlohmann::ordered_json correction_steps_json(const CorrectionDetails& details);

}  // namespace truebearing
