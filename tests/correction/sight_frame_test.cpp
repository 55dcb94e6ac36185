// SPDX-License-Identifier: Apache-2.0
// The frame along the line of sight, and the features that only bearings want: in a turned or mirrored picture they
// are what their parity says.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/bearing_trackers.hpp"
#include "tests/support/error_message.hpp"
#include "truebearing/correction/feature_extractor.hpp"

namespace truebearing::sight_frame_test {
namespace {

using testing::error_message;
using ::testing::HasSubstr;

FeatureSpec feature(FeatureKind kind, const std::string& component = {}, const std::string& companion = {}) {
  FeatureSpec spec;
  spec.kind = kind;
  spec.component = component;
  spec.companion = companion;
  spec.offset = 0.1;
  spec.alpha = 0.2;
  return spec;
}

std::vector<FeatureSpec> sight_features() {
  std::vector<FeatureSpec> specs{feature(FeatureKind::log_range),
                                 feature(FeatureKind::log_range, "", "other"),
                                 feature(FeatureKind::log_first_range),
                                 feature(FeatureKind::log_time),
                                 feature(FeatureKind::bearing_rate),
                                 feature(FeatureKind::bearing_rate, "", "other"),
                                 feature(FeatureKind::own_velocity, "along_mps"),
                                 feature(FeatureKind::own_velocity, "cross_mps"),
                                 feature(FeatureKind::log_sigma, "along_m"),
                                 feature(FeatureKind::log_mean_nis)};
  for (const char* component : {"along_m", "cross_m", "along_mps", "cross_mps"}) {
    specs.push_back(feature(FeatureKind::companion_difference, component, "other"));
    specs.back().scale_is_sigma = true;
  }
  return specs;
}

// Two trackers of bearings and the features of what they say.
class Sight {
 public:
  explicit Sight(std::vector<FeatureSpec> specs)
      : base_(testing::bearing_tracker<KalmanFilter<4>>()),
        other_(testing::bearing_tracker<LogPolarFilter<>>()),
        extractor_(std::move(specs), plane_space(), Frame::sight, [&](const std::string&) { return base_->blocks(); }) {
  }

  const StepRecord& step(const Measurement& measurement, FeatureExtractor::Features& features) {
    const StepRecord& base = base_->step(measurement)[0];
    const std::vector<const StepRecord*> companions{&other_->step(measurement)[0]};
    extractor_.extract(base, companions, features);
    return base;
  }
  const FrameRotation& rotation() const { return extractor_.rotation(); }

 private:
  std::unique_ptr<Tracker> base_, other_;
  FeatureExtractor extractor_;
};

Measurement mirrored(Measurement measurement) {
  measurement.z = -measurement.z;
  measurement.sensor->position_m.x() *= -1.0;
  measurement.sensor->velocity_mps.x() *= -1.0;
  return measurement;
}

Measurement turned(Measurement measurement) {
  const Eigen::Matrix2d R{{0.6, 0.8}, {-0.8, 0.6}};  // clockwise by atan(4 / 3)
  measurement.z[0] += std::atan2(4.0, 3.0);
  measurement.sensor->position_m = (R * measurement.sensor->position_m + Eigen::Vector2d(500.0, -900.0)).eval();
  measurement.sensor->velocity_mps = (R * measurement.sensor->velocity_mps).eval();
  return measurement;
}

TEST(SightFrame, FeaturesOfAMirroredPictureFollowTheirParity) {
  const std::vector<FeatureSpec> specs = sight_features();
  Sight sight(specs), mirror(specs);
  FeatureExtractor::Features a, b;
  for (const Measurement& measurement : testing::bearings_run(11).measurements) {
    sight.step(measurement, a);
    mirror.step(mirrored(measurement), b);
    for (Eigen::Index i = 0; i < a.size(); ++i) {
      const FeatureSpec& spec = specs[static_cast<std::size_t>(i)];
      ASSERT_NEAR(b[i], mirror_parity(spec, Frame::sight, plane_space()) * a[i], 1e-6 * (1.0 + std::abs(a[i])))
          << describe(spec);
    }
  }
}

TEST(SightFrame, FeaturesDoNotDependOnWhereNorthIs) {
  const std::vector<FeatureSpec> specs = sight_features();
  Sight sight(specs), other(specs);
  FeatureExtractor::Features a, b;
  for (const Measurement& measurement : testing::bearings_run(12).measurements) {
    sight.step(measurement, a);
    other.step(turned(measurement), b);
    for (Eigen::Index i = 0; i < a.size(); ++i)
      ASSERT_NEAR(b[i], a[i], 1e-6 * (1.0 + std::abs(a[i]))) << describe(specs[static_cast<std::size_t>(i)]);
  }
}

TEST(SightFrame, FeaturesAreTheirFormulas) {
  Sight sight({feature(FeatureKind::log_range), feature(FeatureKind::log_time), feature(FeatureKind::bearing_rate),
               feature(FeatureKind::own_velocity, "along_mps"), feature(FeatureKind::own_velocity, "cross_mps"),
               feature(FeatureKind::companion_difference, "along_m", "other"), feature(FeatureKind::log_first_range)});
  FeatureExtractor::Features f;
  double first = 0.0;
  for (const Measurement& measurement : testing::bearings_run(13).measurements) {
    const StepRecord& base = sight.step(measurement, f);
    const Eigen::Vector2d d = base.x.head<2>() - measurement.sensor->position_m;
    const double dt_s = 1e-3;
    const Eigen::Vector2d later = d + dt_s * (base.x.tail<2>() - measurement.sensor->velocity_mps);
    EXPECT_NEAR(f[0], std::log(d.norm()), 1e-12 * f[0]);
    if (measurement.time_s == 0.0) first = f[0];
    EXPECT_EQ(f[1], std::log(std::max(measurement.time_s, 1.0)));
    EXPECT_EQ(f[6], first);
    EXPECT_NEAR(f[2], (std::atan2(later.x(), later.y()) - std::atan2(d.x(), d.y())) / dt_s, 1e-8);
    const Eigen::Vector2d along = d.normalized(), starboard(along.y(), -along.x());
    EXPECT_NEAR(f[3], along.dot(measurement.sensor->velocity_mps), 1e-12);
    EXPECT_NEAR(f[4], starboard.dot(measurement.sensor->velocity_mps), 1e-12);
    EXPECT_NEAR((sight.rotation().along() - along).norm(), 0.0, 1e-12);
  }
}

TEST(SightFrame, WithoutASensorIsSeenFromTheOrigin) {
  const BoundedVector x = Eigen::Vector4d(30.0, 40.0, 1.0, -2.0);
  EXPECT_LT((FrameRotation(Frame::sight, x).along() - Eigen::Vector2d(0.6, 0.8)).norm(), 1e-12);
  const FrameRotation moved(Frame::sight, x, SensorState{{30.0, 0.0}, {0.0, 0.0}});
  EXPECT_EQ(moved.along(), Eigen::Vector2d(0.0, 1.0));
  EXPECT_EQ(FrameRotation(Frame::sight, x, SensorState{{30.0, 40.0}, {0.0, 0.0}}).along(), Eigen::Vector2d(0.0, 1.0));
}

TEST(SightFrame, HasANameAndRefusesALine) {
  for (const Frame frame : {Frame::state, Frame::track, Frame::sight}) EXPECT_EQ(frame_of(to_string(frame)), frame);
  EXPECT_THAT(error_message([] { space_in(Frame::sight, line_space()); }), HasSubstr("sight"));
  const auto refusal = [](const FeatureSpec& spec) {
    return error_message([&] {
      FeatureExtractor({spec}, plane_space(), Frame::sight, [](const std::string&) { return RecordBlocks{}; });
    });
  };
  EXPECT_THAT(refusal(feature(FeatureKind::own_velocity, "along_m")), HasSubstr("no velocity"));
  EXPECT_THAT(refusal(feature(FeatureKind::own_velocity, "east_mps")), HasSubstr("not in the state"));
}

}  // namespace
}  // namespace truebearing::sight_frame_test
