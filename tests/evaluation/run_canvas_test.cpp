// SPDX-License-Identifier: Apache-2.0
#include "truebearing/evaluation/run_canvas.hpp"

#include <gtest/gtest.h>

#include "truebearing/core/angle.hpp"
#include "truebearing/recording/recording.hpp"

namespace truebearing::run_canvas_test {
namespace {

// A target in space is drawn along the ground: of a slant range what its elevation leaves.
TEST(RunCanvas, DrawsTheGroundTrackOfATargetInSpace) {
  const RunCanvas canvas(space_space());
  EXPECT_TRUE(canvas.in_plane());
  Recording recording;
  recording.measured = {"range_m", "bearing_deg", "elevation_deg"};
  recording.measurements.push_back(
      {.time_s = 1.0, .z = Eigen::Vector3d(2000.0, radians(90.0), radians(60.0)), .sigma = {}, .sensor = {}});
  RunPicture picture;
  canvas.add_measured(recording, {}, picture);
  ASSERT_EQ(picture.measured.x.size(), 1u);
  EXPECT_NEAR(picture.measured.x[0], 1000.0, 1e-9);
  EXPECT_NEAR(picture.measured.y[0], 0.0, 1e-9);

  StepRecord record;
  record.space = &space_space();
  record.x = Eigen::Matrix<double, 6, 1>{1.0, 2.0, 3.0, 4.0, 5.0, 6.0};
  record.P = BoundedMatrix::Identity(6, 6);
  DrawnTrack track;
  canvas.add(record, track);
  EXPECT_EQ(track.line.x.front(), 1.0);
  EXPECT_EQ(track.line.y.front(), 2.0);
}

// From where the measurement says, else from where the study says that its sensor stands.
TEST(RunCanvas, DrawsMeasurementsFromTheirSites) {
  const RunCanvas canvas(plane_space());
  Recording recording;
  recording.measured = {"range_m", "bearing_deg"};
  const Measurement seen{.time_s = 1.0, .z = Eigen::Vector2d(100.0, radians(90.0)), .sigma = {}, .sensor = {}};
  recording.measurements.assign(3, seen);
  recording.measurements[1].source = 1;
  recording.measurements[2].sensor = SensorState{{7.0, 8.0}, {0.0, 0.0}};
  recording.sources = {{"near", recording.measured}, {"far", recording.measured}};
  RunPicture picture;
  canvas.add_measured(recording, {{{10.0, 20.0, 0.0}, {5000.0, 0.0, 30.0}}}, picture);
  ASSERT_EQ(picture.measured.x.size(), 3u);
  const std::vector<double> east_m{110.0, 5100.0, 107.0}, north_m{20.0, 0.0, 8.0};
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_NEAR(picture.measured.x[k], east_m[k], 1e-9);
    EXPECT_NEAR(picture.measured.y[k], north_m[k], 1e-9);
  }
}

TEST(RunCanvas, DrawsALineOverTime) {
  EXPECT_FALSE(RunCanvas(line_space()).in_plane());
}

}  // namespace
}  // namespace truebearing::run_canvas_test
