// SPDX-License-Identifier: Apache-2.0
// The frames of a correction in space: along and across turn about the vertical, and up stays up.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/error_message.hpp"
#include "truebearing/core/covariance.hpp"
#include "truebearing/core/random.hpp"
#include "truebearing/correction/feature_extractor.hpp"

namespace truebearing::space_frame_test {
namespace {

using State = Eigen::Matrix<double, 6, 1>;
using testing::error_message;
using ::testing::HasSubstr;

const State kState{3000.0, 4000.0, 500.0, 30.0, -40.0, 7.0};

TEST(SpaceFrame, LeavesUpAlone) {
  const FrameRotation track(Frame::track, kState), sight(Frame::sight, kState);
  const State along_track{0.6 * 3000.0 - 0.8 * 4000.0, -0.8 * 3000.0 - 0.6 * 4000.0, 500.0, 50.0, 0.0, 7.0};
  EXPECT_LT((track.vector(kState) - along_track).norm(), 1e-9);
  EXPECT_LT((sight.vector(kState).head<3>() - Eigen::Vector3d(5000.0, 0.0, 500.0)).norm(), 1e-9);
  for (Eigen::Index i = 0; i < 6; ++i) EXPECT_NEAR(track.component(kState, i), along_track[i], 1e-9) << i;
  EXPECT_LT((track.vector(track.vector(kState)) - kState).norm(), 1e-9) << "the way back is the same";
}

TEST(SpaceFrame, TurnsCovariancesAsItTurnsStates) {
  RandomStream random({71, Role::evaluation, 0}, StreamId::test);
  Eigen::Matrix<double, 6, 6> root;
  for (double& value : root.reshaped()) value = random.normal();
  const FrameRotation track(Frame::track, kState);
  Eigen::Matrix<double, 6, 6> T;
  for (int i = 0; i < 6; ++i) T.col(i) = track.vector(BoundedVector(State::Unit(i)));
  const BoundedMatrix P = root * root.transpose();
  EXPECT_LT((track.covariance(P) - T * P * T.transpose()).norm(), 1e-12 * P.norm());
}

TEST(SpaceFrame, NamesItsComponentsAndTheirParity) {
  const StateSpace& track = space_in(Frame::track, space_space());
  EXPECT_EQ(track.components,
            (std::vector<std::string>{"along_m", "cross_m", "up_m", "along_mps", "cross_mps", "up_mps"}));
  const int parity[] = {1, -1, 1, 1, -1, 1};
  for (int i = 0; i < 6; ++i) EXPECT_EQ(component_parity(Frame::track, space_space(), i), parity[i]) << i;
  for (int i = 0; i < 4; ++i) EXPECT_EQ(component_parity(Frame::sight, plane_space(), i), i % 2 == 0 ? 1 : -1) << i;
  for (int i = 0; i < 6; ++i) EXPECT_EQ(component_parity(Frame::state, space_space(), i), -1) << i;
}

// Of a picture that is turned about the vertical the features are the same.
TEST(SpaceFrame, FeaturesDoNotDependOnWhereNorthIs) {
  std::vector<FeatureSpec> specs;
  for (const char* component : {"along_m", "cross_m", "up_m"}) {
    FeatureSpec spec;
    spec.kind = FeatureKind::innovation;
    spec.component = component;
    specs.push_back(spec);
  }
  for (const char* component : {"up_m", "along_mps", "cross_mps", "up_mps"}) {
    FeatureSpec spec;
    spec.kind = FeatureKind::log_sigma;
    spec.component = component;
    specs.push_back(spec);
  }
  for (const FeatureKind kind : {FeatureKind::log_speed, FeatureKind::aspect_sine, FeatureKind::log_range}) {
    FeatureSpec spec;
    spec.kind = kind;
    specs.push_back(spec);
  }
  const auto blocks = [](const std::string&) { return RecordBlocks{.innovation = true, .measures_position = true}; };
  FeatureExtractor one(specs, space_space(), Frame::track, blocks), other = one;

  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  R.topLeftCorner<2, 2>() << 0.6, 0.8, -0.8, 0.6;
  Eigen::Matrix<double, 6, 6> R6 = Eigen::Matrix<double, 6, 6>::Zero();
  R6.topLeftCorner<3, 3>() = R6.bottomRightCorner<3, 3>() = R;
  Eigen::Matrix<double, 6, 6> root;
  RandomStream random({72, Role::evaluation, 0}, StreamId::test);
  for (double& value : root.reshaped()) value = random.normal();
  StepRecord record;
  record.space = &space_space();
  record.x = kState;
  record.P = root * root.transpose();
  const Eigen::Matrix3d S = record.P.topLeftCorner<3, 3>();
  const Eigen::Vector3d nu(1.0, -2.0, 3.0);
  record.innovation = Innovation{Eigen::Vector3d(kState.head<3>() + nu), nu, S, 1.0};
  StepRecord turned = record;
  turned.x = R6 * record.x;
  turned.P = R6 * record.P * R6.transpose();
  turned.innovation = Innovation{R * record.innovation->z, R * nu, R * S * R.transpose(), 1.0};
  FeatureExtractor::Features a, b;
  one.extract(record, {}, a);
  other.extract(turned, {}, b);
  EXPECT_LT((a - b).norm(), 1e-9 * a.norm());
  EXPECT_NEAR(a[2], 3.0 / std::sqrt(S(2, 2)), 1e-12) << "up is by itself";
  EXPECT_NEAR(a[7], std::log(50.0), 1e-12);
}

TEST(SpaceFrame, RefusesALineAndAVelocityThatIsNotLevel) {
  EXPECT_THAT(error_message([] { space_in(Frame::track, line_space()); }), HasSubstr("the space plane or space"));
  FeatureSpec own;
  own.kind = FeatureKind::own_velocity;
  own.component = "up_mps";
  EXPECT_THAT(error_message([&] {
                FeatureExtractor({own}, space_space(), Frame::track, [](const std::string&) { return RecordBlocks{}; });
              }),
              HasSubstr("level velocity"));
}

}  // namespace
}  // namespace truebearing::space_frame_test
