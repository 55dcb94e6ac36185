// SPDX-License-Identifier: Apache-2.0
// A corrected tracker that runs allocates nothing.
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <string>

#include "tests/support/allocation_count.hpp"
#include "tests/support/correction_models.hpp"
#include "tests/support/fakes.hpp"
#include "tests/support/line_trackers.hpp"
#include "tests/support/recurrent_models.hpp"
#include "truebearing/core/constants.hpp"
#include "truebearing/correction/corrected_tracker.hpp"
#include "truebearing/correction/network.hpp"
#include "truebearing/evaluation/tracker_set.hpp"
#include "truebearing/tracker/filter_bank.hpp"
#include "truebearing/tracker/particle_limit.hpp"
#include "truebearing/tracker/position_sensor.hpp"

namespace truebearing::correction_allocation_test {
namespace {

using testing::allocations_of;
using testing::position;
using testing::radar_log;
using testing::RadarFilter;

// What keeps the tests below honest: each way to the heap is seen.
TEST(Allocation, IsCounted) {
  std::string text;
  Eigen::VectorXd vector;
  double* number = nullptr;
  EXPECT_GT(allocations_of([&] { text.assign(100, 'x'); }), 0);
  EXPECT_GT(allocations_of([&] { vector.resize(100); }), 0);
  EXPECT_GT(allocations_of([&] { number = new double(1.0); }), 0);
  EXPECT_EQ(allocations_of([&] { *number += vector[0]; }), 0);
  delete number;
}

std::vector<Measurement> troubled_log() {
  std::vector<Measurement> log;
  for (Measurement measurement : radar_log(1, 240)) {
    const int k = static_cast<int>(measurement.time_s);
    if (k % 9 == 0) measurement.z[0] = kNaN;
    if (k % 31 == 0) measurement.z[0] = 1e308;
    log.push_back(measurement);
    if (k % 7 == 0) log.push_back(measurement);
    if (k % 17 == 0) log.push_back(position(measurement.time_s - 3.0, 0.0));
  }
  return log;
}

Ensemble radar_ensemble() {
  Ensemble ensemble;
  RadarFilter radar;
  radar.options = {.gate_nis = 9.0, .lost_after_s = 20.0};
  ensemble.add("plain", radar.tracker());
  radar.variance = {1e6, 5e4};
  ensemble.add("tuned", radar.tracker());
  ensemble.add("wide", radar.tracker());
  return ensemble;
}

std::shared_ptr<const CorrectionModel> radar_model() {
  RandomStream random({}, StreamId::test);
  CorrectionModel model = testing::line_model(testing::radar_features(), testing::random_parameters(random, 4, 16, 2),
                                              "plain", "tuned", "wide");
  model.gate = testing::box(4, -3.0, 6.0);
  return testing::shared(model);
}

// The first pass warms up, with everything in it that can happen; the second must do without the heap.
long allocations_of_second_pass(Tracker& tracker) {
  const std::vector<Measurement> log = troubled_log();
  for (const Measurement& measurement : log) tracker.step(measurement);
  tracker.reset();
  for (int k = 0; k < 5; ++k) tracker.step(log[static_cast<std::size_t>(k)]);
  return allocations_of([&] {
    for (std::size_t k = 5; k < log.size(); ++k) tracker.step(log[k]);
  });
}

TEST(FuzzyNetwork, EvaluationAllocatesNothing) {
  RandomStream random({}, StreamId::test);
  const FuzzyNetwork network(testing::random_parameters(random, 4, 16, 2));
  const FuzzyNetwork::Inputs input = FuzzyNetwork::Inputs::NullaryExpr(4, [&] { return random.normal(); });
  FuzzyNetwork::Strengths phi;
  FuzzyNetwork::Outputs output;
  EXPECT_EQ(allocations_of([&] {
              network.strengths(input, phi);
              output = network.output(phi);
            }),
            0);
  EXPECT_TRUE(output.allFinite());
}

TEST(CorrectedTracker, StepsAllocateNothing) {
  CorrectedTracker tracker(radar_ensemble(), radar_model());
  EXPECT_EQ(allocations_of_second_pass(tracker), 0);
}

TEST(FilterTracker, StepsAllocateNothing) {
  RadarFilter radar;
  radar.options = {.gate_nis = 9.0, .lost_after_s = 20.0};
  EXPECT_EQ(allocations_of_second_pass(*radar.tracker()), 0);
}

TEST(FilterBank, StepsAllocateNothing) {
  EXPECT_EQ(allocations_of_second_pass(*testing::radar_bank(std::vector<RadarFilter>(10))), 0);
}

// The target jumps away, so that the track begins afresh on the way.
TEST(ParticleLimit, StepsAllocateNothing) {
  ParticleLimitOptions options;
  options.particles = 200;
  ParticleLimit tracker(sensor_of(PositionSensor<2>{{100.0, 100.0}}), options);
  std::vector<Measurement> log = testing::plane_log(1, 100);
  for (std::size_t k = 50; k < log.size(); ++k) log[k].z[0] += 1e5;
  EXPECT_EQ(allocations_of([&] {
              for (const Measurement& measurement : log) tracker.step(measurement);
            }),
            0);
  EXPECT_GT(tracker.fresh_starts(), 0);
}

TEST(CorrectedTracker, StepsInThePlaneAllocateNothingWithEitherNetwork) {
  for (const CorrectionModel& model : {testing::plane_model(1), testing::recurrent_plane_model(1)}) {
    CorrectedTracker tracker(testing::plane_ensemble(), testing::shared(model));
    const std::vector<Measurement> log = testing::plane_log(1, 100);
    for (int k = 0; k < 5; ++k) tracker.step(log[static_cast<std::size_t>(k)]);
    EXPECT_EQ(allocations_of([&] {
                for (std::size_t k = 5; k < log.size(); ++k) tracker.step(log[k]);
              }),
              0)
        << describe(model.network);
  }
}

// A tracker that allocates in its steps must be caught, wherever it sits.
TEST(Allocation, OfATrackerThatAllocatesIsCaught) {
  testing::FakeTracker tracker(line_space(), [](const Measurement& measurement, std::size_t, auto& said) {
    const Eigen::MatrixXd square = Eigen::MatrixXd::Constant(20, 20, measurement.time_s);
    said.records.push_back(testing::fake_record(line_space(), measurement, {}, {}));
    said.records.back().time_s = square.trace();
  });
  EXPECT_GE(allocations_of_second_pass(tracker), 240);
}

TEST(TrackerSet, StepsAllocateNothing) {
  TrackerSet set(radar_ensemble());
  set.show_member("plain");
  set.show_correction("nfnn", radar_model(), {});
  const std::vector<Measurement> log = troubled_log();
  for (const Measurement& measurement : log) set.step(measurement);
  set.reset();
  for (int k = 0; k < 5; ++k) set.step(log[static_cast<std::size_t>(k)]);
  EXPECT_EQ(allocations_of([&] {
              for (std::size_t k = 5; k < log.size(); ++k) set.step(log[k]);
            }),
            0);
}

}  // namespace
}  // namespace truebearing::correction_allocation_test
