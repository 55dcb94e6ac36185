// SPDX-License-Identifier: Apache-2.0
#include "truebearing/correction/correction_design.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/correction_models.hpp"

namespace truebearing::correction_design_test {
namespace {

CorrectionDesign design() {
  CorrectionDesign made;
  made.base = made.reference = "plain";
  made.covariance_of = "wide";
  made.features = testing::radar_features();
  return made;
}

TEST(CorrectionDesign, MembersAreNamedOnce) {
  CorrectionDesign made = design();
  EXPECT_THAT(made.members(), ::testing::ElementsAre("plain", "wide"));
  made.reference = "tuned";
  made.features.back().companion = "imm";
  EXPECT_THAT(made.members(), ::testing::ElementsAre("plain", "tuned", "wide", "imm"));
}

// Whatever may differ is named: a field that == compares and differences() forgets would show here.
TEST(CorrectionDesign, DifferencesAreNamedByTheirKeys) {
  EXPECT_EQ(differences(design(), design()), "");
  CorrectionDesign other = design();
  other.base = "tuned";
  EXPECT_EQ(differences(design(), other), "base");
  other.reference = "tuned";
  other.covariance_of = "tuned";
  other.frame = Frame::track;
  other.output_in_sigma = other.covariance_moments = true;
  other.features.front().scale = 2.0;
  EXPECT_NE(design(), other);
  EXPECT_EQ(differences(design(), other), "base, reference, covariance_of, frame, output_in, covariance, features");
}

}  // namespace
}  // namespace truebearing::correction_design_test
