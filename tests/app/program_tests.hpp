// SPDX-License-Identifier: Apache-2.0
// What tests of the built program are written in: how they run it, where, and what they expect of its words. Each has a
// namespace of its own inside of this one.
#pragma once

#include <gmock/gmock.h>

#include "tests/app/program.hpp"

namespace truebearing::app_test {

using ::testing::AllOf;
using ::testing::HasSubstr;
using testing::is_one_line;
using testing::kStudy;
using ::testing::Not;
using testing::Outcome;
using testing::replaced;
using testing::run;
using testing::start;
using testing::TemporaryFolder;
using testing::wait_for;
using testing::write_study;

/// kStudy with plain and tuned alone, which need no training.
inline std::string tuned_study() {
  return replaced(kStudy.substr(0, kStudy.find("[trackers.wide]")), "\"nfnn - tuned\"", "\"tuned - plain\"");
}

inline std::string last_line(const std::string& text) {
  return text.substr(text.rfind('\n', text.size() - 2) + 1);
}

}  // namespace truebearing::app_test
