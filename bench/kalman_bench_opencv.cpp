// SPDX-License-Identifier: Apache-2.0
// The benchmarks of kalman_bench.cpp with OpenCV's cv::KalmanFilter.
#include <benchmark/benchmark.h>

#include <opencv2/core.hpp>
#include <opencv2/video/tracking.hpp>

#include "kalman_bench.hpp"

namespace truebearing::bench {
namespace {

template <int Dim>
void opencv(benchmark::State& state) {
  const auto east_m = measurements(15.0), north_m = measurements(-7.0);
  for (auto _ : state) {
    cv::KalmanFilter filter(2 * Dim, Dim, 0, CV_64F);
    cv::setIdentity(filter.transitionMatrix);
    cv::setIdentity(filter.measurementMatrix);
    cv::setIdentity(filter.measurementNoiseCov, kSigma_m * kSigma_m);
    cv::setIdentity(filter.errorCovPost, kP0);
    filter.processNoiseCov = 0.0;
    for (int i = 0; i < Dim; ++i) {
      filter.transitionMatrix.at<double>(i, Dim + i) = kPeriod_s;
      filter.processNoiseCov.at<double>(i, i) = kDensity_m2ps3 / 3;
      filter.processNoiseCov.at<double>(i, Dim + i) = filter.processNoiseCov.at<double>(Dim + i, i) =
          kDensity_m2ps3 / 2;
      filter.processNoiseCov.at<double>(Dim + i, Dim + i) = kDensity_m2ps3;
    }
    cv::Mat z(Dim, 1, CV_64F);
    for (std::size_t k = 0; k < kSteps; ++k) {
      z.at<double>(0) = east_m[k];
      if constexpr (Dim == 2) z.at<double>(1) = north_m[k];
      filter.predict();
      filter.correct(z);
      double position_m = filter.statePost.at<double>(0);
      benchmark::DoNotOptimize(position_m);
    }
  }
  state.counters["per_step"] = benchmark::Counter(
      static_cast<double>(kSteps), benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}
BENCHMARK_TEMPLATE(opencv, 1)->Name("opencv_2_1");
BENCHMARK_TEMPLATE(opencv, 2)->Name("opencv_4_2");

}  // namespace
}  // namespace truebearing::bench
