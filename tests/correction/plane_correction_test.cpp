// SPDX-License-Identifier: Apache-2.0
// A correction in the plane, whole: track frame, outputs in standard deviations, residual moments, gate, referee,
// kappa.
#include <gtest/gtest.h>

#include "tests/support/plane_trackers.hpp"
#include "truebearing/core/constants.hpp"
#include "truebearing/core/covariance.hpp"
#include "truebearing/core/error.hpp"
#include "truebearing/correction/model_file.hpp"

namespace truebearing::plane_correction_test {
namespace {

using testing::plane_ensemble;
using testing::plane_log;
using testing::plane_model;

const CorrectionBounds kWithReferee{.referee = RefereeOptions{}};

CorrectedTracker corrected(CorrectionModel model, const CorrectionBounds& bounds = kWithReferee) {
  return {plane_ensemble(), testing::shared(std::move(model)), bounds};
}

TEST(PlaneCorrection, TurnsWithTheTarget) {
  const Eigen::Matrix2d R{{0.6, 0.8}, {-0.8, 0.6}};
  Eigen::Matrix4d R4 = Eigen::Matrix4d::Zero();
  R4.topLeftCorner<2, 2>() = R4.bottomRightCorner<2, 2>() = R;
  CorrectedTracker tracker = corrected(plane_model(1)), turned = corrected(plane_model(1));
  double moved = 0.0;
  for (const Measurement& measurement : plane_log(2, 120)) {
    Measurement other = measurement;
    other.z = R * measurement.z;
    const auto a = tracker.step(measurement), b = turned.step(other);
    ASSERT_EQ(a.size(), b.size());
    if (a.empty()) continue;
    EXPECT_LT((b[0].x - R4 * a[0].x).norm(), 1e-8 * a[0].x.norm());
    EXPECT_LT((b[0].P - R4 * a[0].P * R4.transpose()).norm(), 1e-8 * a[0].P.norm());
    moved = std::max(moved, a[0].correction->distance_sigmas);
  }
  EXPECT_GT(moved, 0.1) << "there was a correction to turn";
}

TEST(PlaneCorrection, StaysWithinKappaAndPublishesACovarianceWhateverTheNetworkSays) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    CorrectionModel model = plane_model(seed, std::pow(10.0, static_cast<double>(seed % 7)));
    model.gate.reset();
    CorrectedTracker tracker = corrected(model);
    Ensemble ensemble = plane_ensemble();
    for (const Measurement& measurement : plane_log(seed, 60)) {
      ensemble.step(measurement);
      const auto records = tracker.step(measurement);
      if (records.empty()) continue;
      const StepRecord& reference = ensemble.records(ensemble.index("tuned"))[0];
      const double squared = mahalanobis_squared(reference.P, BoundedVector(records[0].x - reference.x));
      EXPECT_LE(std::sqrt(squared), 3.0 * (1.0 + 1e-9));
      EXPECT_TRUE(is_covariance(records[0].P));
    }
  }
}

TEST(PlaneCorrection, RefereeTakesTheWeightFromANetworkThatIsWrong) {
  CorrectionModel model = plane_model(3, 5.0);
  model.gate.reset();
  CorrectedTracker with = corrected(model);
  CorrectedTracker without = corrected(model, {});
  double gate = 1.0;
  for (const Measurement& measurement : plane_log(4, 300)) {
    const auto a = with.step(measurement), b = without.step(measurement);
    if (a.empty()) continue;
    gate = a[0].correction->gate;
    EXPECT_EQ(b[0].correction->gate, 1.0);
  }
  EXPECT_LT(gate, 0.01);
}

// Taught at one second without a gap, and open to everything else.
CorrectionModel one_second_model() {
  CorrectionModel model = plane_model(3);
  model.gate = testing::box(static_cast<Eigen::Index>(model.design.features.size()), -1e9, 1e9, 1e9);
  model.gate->intervals = {.low_s = 1.0, .high_s = 1.0, .longest_coast_s = 0.0};
  return model;
}

double last_gate(std::vector<Measurement> log, double stretch, const CorrectionModel& model = one_second_model(),
                 const CorrectionBounds& bounds = {}) {
  CorrectedTracker tracker = corrected(model, bounds);
  double gate = -1.0;
  for (Measurement& measurement : log) {
    measurement.time_s *= stretch;
    const auto records = tracker.step(measurement);
    if (!records.empty() && records[0].correction) gate = records[0].correction->gate;
  }
  return gate;
}

TEST(PlaneCorrection, GateClosesAtPeriodsThatWereNotTaught) {
  const std::vector<Measurement> log = plane_log(4, 30);
  EXPECT_EQ(last_gate(log, 1.0), 1.0);
  EXPECT_GT(last_gate(log, 1.05), 0.8);
  for (const double stretch : {0.5, 2.0, 3.0}) EXPECT_LT(last_gate(log, stretch), 1e-6) << stretch;
}

TEST(PlaneCorrection, GateClosesAtIntervalsLongerThanTheStudyPromises) {
  CorrectionModel model = one_second_model();
  model.gate->intervals.high_s = 10.0;
  const std::vector<Measurement> log = plane_log(4, 30);
  EXPECT_EQ(last_gate(log, 5.0, model), 1.0);
  for (const auto& intervals : {model.gate->intervals, IntervalBox{}}) {  // what was taught may not be known
    model.gate->intervals = intervals;
    EXPECT_EQ(last_gate(log, 2.0, model, {.longest_interval_s = 2.5}), 1.0);
    EXPECT_LT(last_gate(log, 5.0, model, {.longest_interval_s = 2.5}), 1e-6);
  }
  EXPECT_EQ(last_gate(log, 5.0, model, {.gate = false, .longest_interval_s = 2.5}), 1.0);
  EXPECT_THROW(corrected(model, {.longest_interval_s = 0.0}), InputError);
}

TEST(PlaneCorrection, GateClosesWhileTheBaseCoastsAndForAWhileAfter) {
  std::vector<Measurement> log = plane_log(4, 30);
  std::vector<double> gates;
  CorrectedTracker tracker = corrected(one_second_model(), {});
  for (std::size_t k = 0; k < log.size(); ++k) {
    if (k == 20) log[k].z.setConstant(kNaN);
    const auto records = tracker.step(log[k]);
    gates.push_back(records.empty() || !records[0].correction ? -1.0 : records[0].correction->gate);
  }
  EXPECT_EQ(gates[19], 1.0);
  for (std::size_t k = 20; k <= 23; ++k) EXPECT_LT(gates[k], 1e-6) << k;
  EXPECT_EQ(gates[24], 1.0);
}

TEST(PlaneCorrection, EmptyRowLeavesNoTraceInWhatTheRefereeRemembers) {
  CorrectionModel model = plane_model(3, 3.0);
  model.gate.reset();
  CorrectedTracker with = corrected(model), without = corrected(model);
  for (const Measurement& measurement : plane_log(5, 60)) {
    const auto a = without.step(measurement);
    const std::vector<StepRecord> kept(a.begin(), a.end());
    Measurement empty = measurement;
    empty.time_s += 0.3;
    empty.z.setConstant(kNaN);
    const auto b = with.step(measurement);
    ASSERT_EQ(kept.size(), b.size());
    for (std::size_t i = 0; i < kept.size(); ++i) {
      EXPECT_EQ(kept[i].x, b[i].x);
      EXPECT_EQ(kept[i].P, b[i].P);
    }
    with.step(empty);
  }
}

TEST(PlaneCorrection, ModelFileKeepsEverything) {
  const CorrectionModel model = plane_model(5);
  const std::string saved = model_text(model);
  const CorrectionModel loaded = parse_model(saved, "model.json");
  EXPECT_EQ(model_text(loaded), saved);
  EXPECT_EQ(differences(loaded.design, model.design), "");
  EXPECT_EQ(loaded.design.frame, Frame::track);
  EXPECT_TRUE(loaded.design.output_in_sigma);
  EXPECT_EQ(loaded.rules().moments, model.rules().moments);
  EXPECT_EQ(loaded.rules().inflation.size(), 0);
}

TEST(PlaneCorrection, ModelFileKeepsTheIntervalsThatWereTaughtAndRefusesThoseThatAreNone) {
  CorrectionModel model = one_second_model();
  for (const IntervalBox& intervals : {IntervalBox{0.5, 3.0, 2.0}, IntervalBox{0.5, kInfinity, 0.0}}) {
    model.gate->intervals = intervals;
    EXPECT_EQ(parse_model(model_text(model), "model.json").gate->intervals, intervals);
  }
  for (const IntervalBox& intervals :
       {IntervalBox{-1.0, 3.0, 0.0}, IntervalBox{4.0, 3.0, 0.0}, IntervalBox{1.0, 3.0, -1.0}}) {
    model.gate->intervals = intervals;
    EXPECT_THROW(parse_model(model_text(model), "model.json"), InputError);
  }
}

TEST(PlaneCorrection, MomentsThatAreNoCovarianceAreRefused) {
  CorrectionModel model = plane_model(6);
  model.rules().moments(2, 0) = -1.0;
  EXPECT_THROW(model.validate(), InputError);
  model = plane_model(6);
  model.rules().inflation = Eigen::VectorXd::Ones(8);
  EXPECT_THROW(model.validate(), InputError);
  model.design.covariance_moments = false;
  EXPECT_THROW(model.validate(), InputError) << "with both heads, whichever the design names";
}

}  // namespace
}  // namespace truebearing::plane_correction_test
