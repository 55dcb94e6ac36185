// SPDX-License-Identifier: Apache-2.0
// The benchmarks of kalman_bench.cpp with the extended Kalman filter of Orocos BFL on its linear models.
#include <benchmark/benchmark.h>
#include <bfl/filter/extendedkalmanfilter.h>
#include <bfl/model/linearanalyticmeasurementmodel_gaussianuncertainty.h>
#include <bfl/model/linearanalyticsystemmodel_gaussianuncertainty.h>
#include <bfl/pdf/linearanalyticconditionalgaussian.h>

#include "kalman_bench.hpp"

namespace truebearing::bench {
namespace {

using MatrixWrapper::ColumnVector;
using MatrixWrapper::Matrix;
using MatrixWrapper::SymmetricMatrix;

template <int Dim>
void bfl(benchmark::State& state) {
  const auto east_m = measurements(15.0), north_m = measurements(-7.0);
  constexpr unsigned kStates = 2 * Dim;
  Matrix F(kStates, kStates), H(Dim, kStates);
  SymmetricMatrix Q(kStates), R(Dim), P0(kStates);
  ColumnVector zero_state(kStates), zero_measurement(Dim);
  F = 0.0;
  H = 0.0;
  Q = 0.0;
  R = 0.0;
  P0 = 0.0;
  zero_state = 0.0;
  zero_measurement = 0.0;
  for (unsigned i = 1; i <= kStates; ++i) {
    F(i, i) = 1.0;
    P0(i, i) = kP0;
  }
  for (unsigned i = 1; i <= Dim; ++i) {
    F(i, Dim + i) = kPeriod_s;
    H(i, i) = 1.0;
    R(i, i) = kSigma_m * kSigma_m;
    Q(i, i) = kDensity_m2ps3 / 3;
    Q(i, Dim + i) = Q(Dim + i, i) = kDensity_m2ps3 / 2;
    Q(Dim + i, Dim + i) = kDensity_m2ps3;
  }
  BFL::LinearAnalyticConditionalGaussian motion_pdf(F, BFL::Gaussian(zero_state, Q));
  BFL::LinearAnalyticSystemModelGaussianUncertainty motion(&motion_pdf);
  BFL::LinearAnalyticConditionalGaussian measurement_pdf(H, BFL::Gaussian(zero_measurement, R));
  BFL::LinearAnalyticMeasurementModelGaussianUncertainty measurement(&measurement_pdf);
  BFL::Gaussian prior(zero_state, P0);
  ColumnVector z(Dim);
  for (auto _ : state) {
    BFL::ExtendedKalmanFilter filter(&prior);
    for (std::size_t k = 0; k < kSteps; ++k) {
      z(1) = east_m[k];
      if constexpr (Dim == 2) z(2) = north_m[k];
      filter.Update(&motion, &measurement, z);
      double position_m = filter.PostGet()->ExpectedValueGet()(1);
      benchmark::DoNotOptimize(position_m);
    }
  }
  state.counters["per_step"] = benchmark::Counter(
      static_cast<double>(kSteps), benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}
BENCHMARK_TEMPLATE(bfl, 1)->Name("bfl_2_1");
BENCHMARK_TEMPLATE(bfl, 2)->Name("bfl_4_2");

}  // namespace
}  // namespace truebearing::bench
