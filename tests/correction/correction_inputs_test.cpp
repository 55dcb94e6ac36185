// SPDX-License-Identifier: Apache-2.0
#include "truebearing/correction/correction_inputs.hpp"

#include <gtest/gtest.h>

#include "tests/support/plane_trackers.hpp"

namespace truebearing::correction_inputs_test {
namespace {

using testing::plane_ensemble;
using testing::plane_model;

// What is taught is what is applied: a difference of states in the units of the output, and back.
TEST(CorrectionInputs, OutputUnitsThereAndBackAreTheSameDifference) {
  Ensemble ensemble = plane_ensemble();
  const CorrectionModel model = plane_model(1);
  CorrectionInputs inputs(model.design, plane_space(), ensemble);
  FeatureExtractor extractor = inputs.extractor();
  CorrectionInputs::Features features;
  int steps = 0;
  for (const Measurement& measurement : testing::plane_log(1, 50)) {
    ensemble.step(measurement);
    const CorrectionInputs::Records step = inputs.records(ensemble, 0);
    if (!step.complete()) continue;
    ++steps;
    inputs.extract(ensemble, *step.base, extractor, features);
    EXPECT_EQ(features.size(), static_cast<Eigen::Index>(model.design.features.size()));
    const OutputUnits units = inputs.units(extractor, *step.base);
    const BoundedVector d = Eigen::Vector4d(120.0, -40.0, 3.0, 8.0);
    EXPECT_LT((units.state(units.output(d)) - d).norm(), 1e-12 * d.norm());
    const BoundedMatrix one = units.output_covariance(step.base->P);
    EXPECT_LT((one.diagonal() - Eigen::Vector4d::Ones()).norm(), 1e-12) << "in its own standard deviations";
  }
  EXPECT_GT(steps, 40);
}

TEST(CorrectionInputs, TrackWithoutABaseHasNothingToCorrect) {
  Ensemble ensemble = plane_ensemble();
  CorrectionInputs inputs(plane_model(1).design, plane_space(), ensemble);
  for (const Measurement& measurement : testing::plane_log(1, 5)) ensemble.step(measurement);
  EXPECT_TRUE(inputs.records(ensemble, 0).complete());
  EXPECT_FALSE(inputs.records(ensemble, 7).complete());
}

}  // namespace
}  // namespace truebearing::correction_inputs_test
