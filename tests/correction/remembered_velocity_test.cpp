// SPDX-License-Identifier: Apache-2.0
// Features that remember how a target sailed before it left a mode.
#include <gtest/gtest.h>

#include "truebearing/correction/feature_extractor.hpp"

namespace truebearing::remembered_velocity_test {
namespace {

constexpr double kAlpha = 0.25;

StepRecord sailing(double time_s, const Eigen::Vector2d& velocity_mps, double steady) {
  StepRecord record;
  record.time_s = time_s;
  record.space = &plane_space();
  record.x = Eigen::Vector4d(0.0, 5000.0, velocity_mps.x(), velocity_mps.y());
  record.P = Eigen::Matrix4d::Identity();
  record.sensor = SensorState{};
  record.innovation = Innovation{BoundedVector::Zero(1), BoundedVector::Zero(1), BoundedMatrix::Identity(1, 1), 0.0};
  record.mode_probabilities = Eigen::Vector2d(steady, 1.0 - steady);
  return record;
}

class Remembered {
 public:
  Remembered() {
    FeatureSpec speed{.kind = FeatureKind::speed_change, .alpha = kAlpha, .mode = 1};
    FeatureSpec along{.kind = FeatureKind::velocity_change, .component = "along_mps", .alpha = kAlpha, .scale = 2.0};
    along.mode = 1;
    FeatureSpec cross = along;
    cross.component = "cross_mps";
    extractor_ = FeatureExtractor({speed, along, cross}, plane_space(), Frame::sight,
                                  [](const std::string&) { return RecordBlocks{.mode_probabilities = true}; });
  }
  Eigen::Vector3d operator()(const StepRecord& record) {
    FeatureExtractor::Features features;
    extractor_.extract(record, {}, features);
    return features;
  }

 private:
  FeatureExtractor extractor_;
};

TEST(RememberedVelocity, BeginsWithWhatIsFirstSeen) {
  Remembered features;
  EXPECT_EQ(features(sailing(0.0, {3.0, 4.0}, 1.0)), Eigen::Vector3d::Zero());
}

// The target is seen due North: along is North, across is East.
TEST(RememberedVelocity, IsKeptWhileTheTargetIsInAnotherMode) {
  Remembered features;
  features(sailing(0.0, {3.0, 4.0}, 1.0));
  for (int k = 1; k < 100; ++k) {
    const Eigen::Vector3d value = features(sailing(k, {8.0, 6.0}, 0.0));
    EXPECT_NEAR(value[0], std::log(2.0), 1e-12);
    EXPECT_NEAR(value[1], 1.0, 1e-12);
    EXPECT_NEAR(value[2], 2.5, 1e-12);
  }
}

TEST(RememberedVelocity, FollowsByItsShareWhileTheTargetIsSteady) {
  Remembered features;
  features(sailing(0.0, {0.0, 4.0}, 1.0));
  const Eigen::Vector3d value = features(sailing(1.0, {0.0, 8.0}, 0.5));
  const double remembered = 4.0 + 0.5 * kAlpha * 4.0;
  EXPECT_NEAR(value[0], std::log(8.0 / remembered), 1e-12);
  EXPECT_NEAR(value[1], (8.0 - remembered) / 2.0, 1e-12);
  EXPECT_EQ(value[2], 0.0);
}

TEST(RememberedVelocity, HoldsWhileNothingIsMeasured) {
  Remembered features;
  features(sailing(0.0, {0.0, 4.0}, 1.0));
  StepRecord coasted = sailing(1.0, {0.0, 8.0}, 1.0);
  coasted.status = StepStatus::coasted;
  EXPECT_NEAR(features(coasted)[0], std::log(2.0), 1e-12);
}

TEST(RememberedVelocity, IsForgottenWithTheTrack) {
  Remembered features;
  features(sailing(0.0, {0.0, 4.0}, 1.0));
  StepRecord other = sailing(1.0, {0.0, 8.0}, 0.0);
  other.track = 1;
  EXPECT_EQ(features(other), Eigen::Vector3d::Zero());
}

TEST(RememberedVelocity, NeedsModes) {
  FeatureSpec speed{.kind = FeatureKind::speed_change, .alpha = kAlpha, .mode = 1};
  EXPECT_ANY_THROW(
      FeatureExtractor({speed}, plane_space(), Frame::sight, [](const std::string&) { return RecordBlocks{}; }));
}

TEST(RememberedVelocity, ChangesSignAcrossInAMirror) {
  FeatureSpec spec{.kind = FeatureKind::velocity_change, .component = "along_mps"};
  EXPECT_EQ(mirror_parity(spec, Frame::sight, plane_space()), +1);
  spec.component = "cross_mps";
  EXPECT_EQ(mirror_parity(spec, Frame::sight, plane_space()), -1);
  EXPECT_EQ(mirror_parity({.kind = FeatureKind::speed_change}, Frame::sight, plane_space()), +1);
}

}  // namespace
}  // namespace truebearing::remembered_velocity_test
