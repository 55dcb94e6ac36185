// SPDX-License-Identifier: Apache-2.0
// Kalman filters of the library against the same algebra written out by hand. Each iteration runs one filter over the
// whole stream from its initial state; the state after every step is consumed.
//     bench_kalman --benchmark_repetitions=9 --benchmark_report_aggregates_only=true
#include "kalman_bench.hpp"

#include <benchmark/benchmark.h>

#include "truebearing/filter/kalman.hpp"
#include "truebearing/measurement/position.hpp"
#include "truebearing/measurement/range_to_site.hpp"
#include "truebearing/motion/constant_velocity.hpp"

namespace truebearing::bench {
namespace {

void per_step(benchmark::State& state) {
  state.counters["per_step"] = benchmark::Counter(
      static_cast<double>(kSteps), benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

/// Conventional constant-velocity algebra on five scalars, without a check of anything: the floor.
void hand_unrolled_2_1(benchmark::State& state) {
  const auto z_m = measurements(15.0);
  double dt = kPeriod_s, q = kDensity_m2ps3, R = kSigma_m * kSigma_m;
  for (auto _ : state) {
    hide(dt);
    hide(q);
    hide(R);
    const double q11 = q * dt * dt * dt / 3, q12 = q * dt * dt / 2, q22 = q * dt;
    double x1 = 0, x2 = 0, p11 = kP0, p12 = 0, p22 = kP0;
    for (const double z : z_m) {
      x1 += dt * x2;
      p11 += dt * (2 * p12 + dt * p22) + q11;
      p12 += dt * p22 + q12;
      p22 += q22;
      const double nu = z - x1, inverse_S = 1 / (p11 + R);
      const double k1 = p11 * inverse_S, k2 = p12 * inverse_S;
      x1 += k1 * nu;
      x2 += k2 * nu;
      p22 -= k2 * p12;
      p12 -= k1 * p12;
      p11 -= k1 * p11;
      benchmark::DoNotOptimize(x1);
    }
    benchmark::DoNotOptimize(x2);
    benchmark::DoNotOptimize(p11 + p12 + p22);
  }
  per_step(state);
}
BENCHMARK(hand_unrolled_2_1);

template <int Dim, typename Form>
void position(benchmark::State& state) {
  const auto east_m = measurements(15.0), north_m = measurements(-7.0);
  constexpr int kStates = 2 * Dim;
  ConstantVelocity<Dim, ContinuousWhiteNoise> motion{{kDensity_m2ps3}};
  Position<Dim> model{Eigen::Matrix<double, Dim, 1>::Constant(kSigma_m)};
  double dt_s = kPeriod_s;
  for (auto _ : state) {
    hide(dt_s);
    hide(motion);
    hide(model);
    KalmanFilter<kStates, Form> filter(Eigen::Matrix<double, kStates, 1>::Zero(),
                                       kP0 * Eigen::Matrix<double, kStates, kStates>::Identity());
    for (std::size_t k = 0; k < kSteps; ++k) {
      Eigen::Matrix<double, Dim, 1> z;
      z(0) = east_m[k];
      if constexpr (Dim == 2) z(1) = north_m[k];
      filter.predict(motion, dt_s);
      filter.update(model, z);
      double position_m = filter.x()(0);
      benchmark::DoNotOptimize(position_m);
    }
    // A copy: the filter's own address must not escape, or every step would store and reload it.
    auto P = filter.P().eval();
    benchmark::DoNotOptimize(P);
  }
  per_step(state);
}
BENCHMARK_TEMPLATE(position, 1, Joseph)->Name("joseph_2_1");
BENCHMARK_TEMPLATE(position, 1, Conventional)->Name("conventional_2_1");
BENCHMARK_TEMPLATE(position, 1, SquareRoot)->Name("square_root_2_1");
BENCHMARK_TEMPLATE(position, 2, Joseph)->Name("joseph_4_2");
BENCHMARK_TEMPLATE(position, 2, Conventional)->Name("conventional_4_2");
BENCHMARK_TEMPLATE(position, 2, SquareRoot)->Name("square_root_4_2");

template <typename Form>
void range(benchmark::State& state) {
  const auto east_m = measurements(15.0);
  ConstantVelocity<2, ContinuousWhiteNoise> motion{{kDensity_m2ps3}};
  RangeToSite<> model{{0.0, -5000.0}, kSigma_m};
  double dt_s = kPeriod_s;
  for (auto _ : state) {
    hide(dt_s);
    hide(motion);
    hide(model);
    KalmanFilter<4, Form> filter(Eigen::Vector4d::Zero(), kP0 * Eigen::Matrix4d::Identity());
    for (const double z : east_m) {
      filter.predict(motion, dt_s);
      filter.update(model, Eigen::Matrix<double, 1, 1>(5000.0 + z));
      double position_m = filter.x()(0);
      benchmark::DoNotOptimize(position_m);
    }
    // A copy: the filter's own address must not escape, or every step would store and reload it.
    auto P = filter.P().eval();
    benchmark::DoNotOptimize(P);
  }
  per_step(state);
}
BENCHMARK_TEMPLATE(range, Joseph)->Name("joseph_range_4_1");
BENCHMARK_TEMPLATE(range, Conventional)->Name("conventional_range_4_1");
BENCHMARK_TEMPLATE(range, SquareRoot)->Name("square_root_range_4_1");

}  // namespace
}  // namespace truebearing::bench
