// SPDX-License-Identifier: Apache-2.0
#include "truebearing/correction/learned_motion.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/error_message.hpp"
#include "tests/support/jacobian.hpp"
#include "truebearing/core/random.hpp"
#include "truebearing/correction/learned_motion_file.hpp"
#include "truebearing/filter/erased_motion.hpp"
#include "truebearing/motion/lorenz.hpp"

namespace truebearing::learned_motion_test {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using testing::error_message;
using ::testing::HasSubstr;

constexpr double kPeriod_s = 0.02;

MotionResidual residual(double size, int states = 3) {
  RandomStream random({31, Role::evaluation, 0}, StreamId::test);
  constexpr int kRules = 6;
  const auto normal = [&] { return random.normal(); };
  return {FuzzyNetwork({.input_mean = Eigen::VectorXd::Constant(states, 1.0),
                        .input_scale = Eigen::VectorXd::Constant(states, 5.0),
                        .input_clip = 4.0,
                        .centres = Eigen::MatrixXd::NullaryExpr(kRules, states, normal),
                        .widths = Eigen::MatrixXd::Constant(kRules, states, 0.8),
                        .consequents = Eigen::MatrixXd::NullaryExpr(kRules, states, normal),
                        .output_scale = Eigen::VectorXd::Constant(states, size)}),
          kPeriod_s,
          {{"study", "a test"}}};
}

LearnedMotion<3> learned(double size) {
  return {erased(LorenzMotion<LorenzTaylor>{{5}, kPeriod_s, 0.2}),
          std::make_shared<const MotionResidual>(residual(size))};
}

Vector3d r(const LearnedMotion<3>& motion, const Vector3d& x) {
  FuzzyNetwork::Strengths phi;
  motion.residual->network.strengths(x, phi);
  return motion.residual->network.output(phi);
}

TEST(LearnedMotion, AddsTheResidualOfOnePeriod) {
  const LearnedMotion<3> motion = learned(0.3);
  const Vector3d x(2.0, -3.0, 5.0), around = motion.around->f(x, kPeriod_s);
  EXPECT_LT((motion.f(x, kPeriod_s) - around - r(motion, x)).norm(), 1e-12);
  EXPECT_GT(r(motion, x).norm(), 1e-3);
  EXPECT_LT((motion.f(x, kPeriod_s / 4) - motion.around->f(x, kPeriod_s / 4) - 0.25 * r(motion, x)).norm(), 1e-12);
  EXPECT_EQ(motion.f(x, 0.0), x);
  EXPECT_EQ(motion.Q(kPeriod_s), motion.around->Q(kPeriod_s));
}

TEST(LearnedMotion, CrossesALongGapInPeriods) {
  const LearnedMotion<3> motion = learned(0.3);
  const Vector3d x(2.0, -3.0, 5.0), half = motion.f(x, kPeriod_s);
  EXPECT_LT((motion.f(x, 2 * kPeriod_s) - motion.f(half, kPeriod_s)).norm(), 1e-12);
  EXPECT_FALSE(motion.f(x, 1e9).allFinite());
}

TEST(LearnedMotion, HasTheJacobianOfCentralDifferences) {
  const LearnedMotion<3> motion = learned(0.3);
  RandomStream random({32, Role::evaluation, 0}, StreamId::test);
  for (int trial = 0; trial < 50; ++trial) {
    const Vector3d x(4.0 * random.normal(), 4.0 * random.normal(), 4.0 * random.normal());
    const double dt_s = random.uniform(0.002, 0.05);
    const Matrix3d expected = testing::central_differences([&](const Vector3d& at) { return motion.f(at, dt_s); }, x,
                                                           Vector3d(1e-4, 1e-4, 1e-4));
    EXPECT_LT((motion.F(x, dt_s) - expected).cwiseAbs().maxCoeff(), 1e-6 * (1.0 + expected.norm()));
  }
}

// Whatever the state, the residual is no larger than the largest that a rule says.
TEST(LearnedMotion, IsBoundedByItsRules) {
  const LearnedMotion<3> motion = learned(0.3);
  const double most = 0.3 * motion.residual->network.parameters().consequents.rowwise().norm().maxCoeff();
  for (const double far : {1.0, 1e3, 1e100})
    EXPECT_LE(r(motion, Vector3d(far, -far, far)).norm(), most * (1.0 + 1e-12));
}

TEST(LearnedMotion, FileIsReadAsItWasWritten) {
  const std::string text = learned_motion_text(residual(0.3));
  const MotionResidual read = parse_learned_motion(text, "a.json");
  EXPECT_EQ(learned_motion_text(read), text);
  EXPECT_EQ(read.network.parameters(), residual(0.3).network.parameters());
  EXPECT_EQ(read.provenance.at("study"), "a test");
}

TEST(LearnedMotion, FileSaysWhatIsWrong) {
  const std::string text = learned_motion_text(residual(0.3));
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string changed = text;
    changed.replace(changed.find(from), from.size(), to);
    return error_message([&] { parse_learned_motion(changed, "a.json"); });
  };
  EXPECT_THAT(with("truebearing-motion", "motion"), HasSubstr("a.json: format"));
  EXPECT_THAT(with("\"version\": 1", "\"version\": 9"), HasSubstr("is 9"));
  EXPECT_THAT(with("\"period_s\": 0.02", "\"period_s\": -1"), HasSubstr("period_s"));
  EXPECT_THAT(with("\"states\": 3", "\"states\": 2"), HasSubstr("input_mean"));
  EXPECT_THAT(with("\"states\": 3", "\"states\": 0.5"), HasSubstr("states"));
  EXPECT_THAT(with("\"width\"", "\"breadth\""), HasSubstr("rules[0]"));
}

}  // namespace
}  // namespace truebearing::learned_motion_test
