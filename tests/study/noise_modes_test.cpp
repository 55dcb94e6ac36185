// SPDX-License-Identifier: Apache-2.0
// How much of what noise of two variances allows the multiple model of bimodal_noise_40db gets: beside a mixture of
// Gaussians that follows the likeliest histories of the noise one by one. TRUEBEARING_MIXTURE_RUNS=10000 says it to two
// hundredths of a dB.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <vector>

#include "tests/support/comparisons.hpp"
#include "tests/support/environment.hpp"

namespace truebearing::noise_modes_test {
namespace {

constexpr std::size_t kHistories = 48;
constexpr double kQ = 1e-4;
constexpr std::array kShares{0.6, 0.4}, kVariances{1.5625, 0.15625};

// One history of the noise: its weight and what the Kalman filter makes of it.
struct History {
  double weight;
  Eigen::Vector2d x;
  Eigen::Matrix2d P;
};

// The one Gaussian of the same mean and covariance.
History merged(const History& a, const History& b) {
  const double weight = a.weight + b.weight, share = weight > 0.0 ? b.weight / weight : 0.0;
  const Eigen::Vector2d apart = b.x - a.x;
  return {weight, a.x + share * apart,
          (1.0 - share) * a.P + share * b.P + share * (1.0 - share) * apart * apart.transpose()};
}

// Both variances for every history, of which the likeliest are kept and the rest taken together.
class Histories {
 public:
  Eigen::Vector2d step(double z) {
    const Eigen::Matrix2d F{{1.0, 1.0}, {0.0, 1.0}};
    std::vector<History> next;
    double total = 0.0;
    for (const History& history : kept_) {
      const Eigen::Vector2d x = F * history.x;
      Eigen::Matrix2d P = F * history.P * F.transpose();
      P(1, 1) += kQ;
      for (std::size_t kind = 0; kind < kShares.size(); ++kind) {
        const double S = P(0, 0) + kVariances[kind], nu = z - x[0];
        const Eigen::Vector2d K = P.col(0) / S;
        const double weight = history.weight * kShares[kind] * std::exp(-0.5 * nu * nu / S) / std::sqrt(S);
        next.push_back({weight, x + K * nu, P - K * P.row(0)});
        total += weight;
      }
    }
    Eigen::Vector2d mean = Eigen::Vector2d::Zero();
    for (History& history : next) mean += (history.weight /= total) * history.x;
    std::sort(next.begin(), next.end(), [](const History& a, const History& b) { return a.weight > b.weight; });
    while (next.size() > kHistories) {
      next[next.size() - 2] = merged(next[next.size() - 2], next.back());
      next.pop_back();
    }
    kept_ = std::move(next);
    return mean;
  }

 private:
  std::vector<History> kept_{{1.0, {0.0, 1.0}, Eigen::Vector2d(1.0, 0.01).asDiagonal()}};
};

TEST(NoiseModes, GetNearlyAllThatTheMixtureAllows) {
  const Study study = testing::load_study("bimodal_noise_40db");
  const auto modes = study.make_tracker("modes");
  const int runs = testing::number_from_environment("TRUEBEARING_MIXTURE_RUNS", 100);
  double of_modes = 0.0, of_histories = 0.0, steps = 0.0;
  for (int run = 0; run < runs; ++run) {
    const Recording recording = study.scenario().simulate({3, Role::evaluation, static_cast<std::uint64_t>(run)});
    modes->reset();
    Histories histories;
    for (std::size_t k = 0; k < recording.measurements.size(); ++k, steps += 2.0) {
      const Eigen::Vector2d truth = recording.truth[0].x[k];
      of_modes += (modes->step(recording.measurements[k])[0].x - truth).squaredNorm();
      of_histories += (histories.step(recording.measurements[k].z[0]) - truth).squaredNorm();
    }
  }
  const double modes_db = 10.0 * std::log10(of_modes / steps), limit_db = 10.0 * std::log10(of_histories / steps);
  std::printf("modes %.3f dB, %zu histories %.3f dB\n", modes_db, kHistories, limit_db);
  EXPECT_LT(modes_db, limit_db + 0.15);
  EXPECT_GT(modes_db, limit_db - 0.05) << "nothing is below it but by chance";
}

}  // namespace
}  // namespace truebearing::noise_modes_test
