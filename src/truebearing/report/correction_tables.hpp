// SPDX-License-Identifier: Apache-2.0
// What corrections did, in words and tables: rules as sentences with how often they fired, features with their scale.
#pragma once

#include <string>

#include "truebearing/report/results.hpp"

namespace truebearing {

/// A paragraph: what the network is, what bounds it, how often it was asked, what lay outside what it was taught.
std::string correction_sentence(const ResultCorrection& correction);
/// A row for each rule; empty where there are none.
std::string rule_table(const ResultCorrection& correction);
/// A row for each feature: its scale, the box that it was taught in, what it was here; empty where they are not told.
std::string feature_table(const ResultCorrection& correction);

}  // namespace truebearing
