// SPDX-License-Identifier: Apache-2.0
// Whether a feature has all that its kind needs (feature_kinds.hpp), and means something where it is asked for.
#pragma once

#include "truebearing/correction/feature_extractor.hpp"

namespace truebearing {

/// space: of the base's state; components: its components in the frame. Throws InputError; see FeatureExtractor.
void check_feature(const FeatureSpec& feature, const StateSpace& space, const StateSpace& components,
                   const FeatureExtractor::BlocksOf& blocks_of);

}  // namespace truebearing
