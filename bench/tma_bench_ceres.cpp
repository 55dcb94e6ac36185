// SPDX-License-Identifier: Apache-2.0
// Ceres Solver: one residual block with an analytic Jacobian, its Levenberg-Marquardt with its own tolerances, one
// thread.
#include <benchmark/benchmark.h>
#include <ceres/ceres.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "tma_bench.hpp"

namespace truebearing::bench {
namespace {

// Parameters are of order one: the position in km, the velocity in km over the whole of the bearings.
struct Scale {
  double position_m = 1000.0;
  double velocity_mps;
};

class BearingsCost final : public ceres::CostFunction {
 public:
  BearingsCost(const BearingsProblem& problem, const Scale& scale) : problem_(problem), scale_(scale) {
    mutable_parameter_block_sizes()->push_back(4);
    set_num_residuals(static_cast<int>(problem.bearings.size()));
  }

  bool Evaluate(const double* const* parameters, double* residuals, double** jacobians) const override {
    const double* p = parameters[0];
    const double east = scale_.position_m * p[0], north = scale_.position_m * p[1];
    const double v_east = scale_.velocity_mps * p[2], v_north = scale_.velocity_mps * p[3];
    const double weight = 1.0 / problem_.sigma_rad;
    double* J = jacobians ? jacobians[0] : nullptr;  // m x 4, row by row
    for (const BearingsProblem::Bearing& bearing : problem_.bearings) {
      const double x = east + v_east * bearing.time_s - bearing.own_ship_m.x();
      const double y = north + v_north * bearing.time_s - bearing.own_ship_m.y();
      *residuals++ = weight * wrapped(bearing.bearing_rad - std::atan2(x, y));
      if (!J) continue;
      const double factor = -weight / (x * x + y * y);
      J[0] = factor * y * scale_.position_m;
      J[1] = -factor * x * scale_.position_m;
      J[2] = factor * y * bearing.time_s * scale_.velocity_mps;
      J[3] = -factor * x * bearing.time_s * scale_.velocity_mps;
      J += 4;
    }
    return true;
  }

 private:
  // Of a difference of two angles in [-pi, pi].
  static double wrapped(double angle) {
    constexpr double kPi = std::numbers::pi;
    return angle > kPi ? angle - 2.0 * kPi : angle < -kPi ? angle + 2.0 * kPi : angle;
  }

  const BearingsProblem& problem_;
  Scale scale_;
};

void ceres_225(benchmark::State& state, ceres::LinearSolverType linear_solver) {
  const BearingsProblem problem = bearings_problem(static_cast<int>(state.range(0)));
  const Scale scale{.velocity_mps = 1000.0 / problem.bearings.back().time_s};
  double x[4] = {};
  ceres::Problem ceres_problem;
  ceres_problem.AddResidualBlock(new BearingsCost(problem, scale), nullptr, x);
  ceres::Solver::Options options;
  options.linear_solver_type = linear_solver;
  options.max_num_iterations = kMostIterations;
  options.num_threads = 1;
  options.logging_type = ceres::SILENT;

  double least = 0.0, iterations = 0.0;
  for (auto _ : state) {
    least = std::numeric_limits<double>::infinity();
    iterations = 0.0;
    for (const Eigen::Vector4d& start : problem.starts) {
      x[0] = start[0] / scale.position_m;
      x[1] = start[1] / scale.position_m;
      x[2] = start[2] / scale.velocity_mps;
      x[3] = start[3] / scale.velocity_mps;
      ceres::Solver::Summary summary;
      ceres::Solve(options, &ceres_problem, &summary);
      if (summary.IsSolutionUsable() && summary.final_cost < least) least = summary.final_cost;
      iterations += static_cast<double>(summary.iterations.size() - 1) / static_cast<double>(problem.starts.size());
    }
    benchmark::DoNotOptimize(least);
  }
  state.counters["least_cost"] = least;
  state.counters["iterations"] = iterations;
}

void ceres_dense_qr(benchmark::State& state) {
  ceres_225(state, ceres::DENSE_QR);
}
void ceres_dense_normal_cholesky(benchmark::State& state) {
  ceres_225(state, ceres::DENSE_NORMAL_CHOLESKY);
}
void sizes(benchmark::internal::Benchmark* benchmark) {
  for (const int bearings : kProblemSizes) benchmark->Arg(bearings);
  benchmark->Unit(benchmark::kMillisecond);
}
BENCHMARK(ceres_dense_qr)->Apply(sizes);
BENCHMARK(ceres_dense_normal_cholesky)->Apply(sizes);

}  // namespace
}  // namespace truebearing::bench
