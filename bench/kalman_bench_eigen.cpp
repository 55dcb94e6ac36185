// SPDX-License-Identifier: Apache-2.0
// The benchmarks of kalman_bench.cpp as one writes them with Eigen's matrices of fixed size: dense products, the inverse
// of S, no structure used and nothing checked.
#include <benchmark/benchmark.h>

#include <Eigen/Core>
#include <Eigen/LU>

#include "kalman_bench.hpp"

namespace truebearing::bench {
namespace {

enum class Update { conventional, joseph };

template <int Dim, Update update>
void eigen(benchmark::State& state) {
  constexpr int kStates = 2 * Dim;
  using State = Eigen::Matrix<double, kStates, 1>;
  using Covariance = Eigen::Matrix<double, kStates, kStates>;
  using Measured = Eigen::Matrix<double, Dim, 1>;
  using Innovations = Eigen::Matrix<double, Dim, Dim>;
  const auto east_m = measurements(15.0), north_m = measurements(-7.0);
  Covariance F = Covariance::Identity(), Q;
  F.template topRightCorner<Dim, Dim>().diagonal().setConstant(kPeriod_s);
  Q.setZero();
  for (int i = 0; i < Dim; ++i) {
    Q(i, i) = kDensity_m2ps3 / 3;
    Q(i, Dim + i) = Q(Dim + i, i) = kDensity_m2ps3 / 2;
    Q(Dim + i, Dim + i) = kDensity_m2ps3;
  }
  Eigen::Matrix<double, Dim, kStates> H = Eigen::Matrix<double, Dim, kStates>::Identity();
  Innovations R = kSigma_m * kSigma_m * Innovations::Identity();
  for (auto _ : state) {
    hide(F);
    hide(Q);
    hide(H);
    hide(R);
    State x = State::Zero();
    Covariance P = kP0 * Covariance::Identity();
    for (std::size_t k = 0; k < kSteps; ++k) {
      Measured z;
      z(0) = east_m[k];
      if constexpr (Dim == 2) z(1) = north_m[k];
      x = F * x;
      P = F * P * F.transpose() + Q;
      const Innovations S = H * P * H.transpose() + R;
      const Eigen::Matrix<double, kStates, Dim> K = P * H.transpose() * S.inverse();
      x += K * (z - H * x);
      const Covariance left = Covariance::Identity() - K * H;
      if constexpr (update == Update::joseph)
        P = left * P * left.transpose() + K * R * K.transpose();
      else
        P = left * P;
      double position_m = x(0);
      benchmark::DoNotOptimize(position_m);
    }
    benchmark::DoNotOptimize(P);
  }
  state.counters["per_step"] = benchmark::Counter(
      static_cast<double>(kSteps), benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}
BENCHMARK_TEMPLATE(eigen, 1, Update::conventional)->Name("eigen_conventional_2_1");
BENCHMARK_TEMPLATE(eigen, 1, Update::joseph)->Name("eigen_joseph_2_1");
BENCHMARK_TEMPLATE(eigen, 2, Update::conventional)->Name("eigen_conventional_4_2");
BENCHMARK_TEMPLATE(eigen, 2, Update::joseph)->Name("eigen_joseph_4_2");

}  // namespace
}  // namespace truebearing::bench
