// SPDX-License-Identifier: Apache-2.0
#include "truebearing/filter/backward_step.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <array>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "tests/filter/linear_model.hpp"
#include "tests/support/statistics.hpp"
#include "truebearing/core/covariance.hpp"
#include "truebearing/core/random.hpp"
#include "truebearing/filter/filter_kinds.hpp"
#include "truebearing/filter/interacting_multiple_model.hpp"
#include "truebearing/measurement/position.hpp"
#include "truebearing/motion/constant_acceleration.hpp"
#include "truebearing/motion/constant_velocity.hpp"

namespace truebearing::backward_step_test {
namespace {

constexpr double kManySteps = 1e-9;
constexpr double kSigma_m = 5.0;

using Cv = ConstantVelocity<1, ContinuousWhiteNoise>;
using Ca = ConstantAcceleration<1, ContinuousWhiteJerk>;
using Vector1 = Eigen::Matrix<double, 1, 1>;

const Position<1> kSensor{Vector1(kSigma_m)};
const Eigen::Vector2d kX0(10.0, 3.0);
const Eigen::Matrix2d kP0 = (Eigen::Matrix2d() << 100.0, 10.0, 10.0, 25.0).finished();

struct Look {
  double dt_s;  // since the one before
  double z_m;
};

// Irregular looks at a target of that motion that begins as N(kX0, kP0); x0: where it was at each.
std::vector<Look> looks(const Cv& motion, std::uint64_t run, int count, std::vector<Eigen::Vector2d>* truth = nullptr) {
  RandomStream random({71, Role::evaluation, run}, StreamId::test);
  const auto draw = [&](const Eigen::Matrix2d& P) {
    Eigen::Vector2d unit;
    for (double& value : unit) value = random.normal();
    return Eigen::Vector2d(Eigen::LLT<Eigen::Matrix2d>(P).matrixL() * unit);
  };
  Eigen::Vector2d x = kX0 + draw(kP0);
  std::vector<Look> all;
  for (int k = 0; k < count; ++k) {
    const double dt_s = random.uniform(0.2, 3.0);
    x = motion.F(dt_s) * x + draw(motion.Q(dt_s));
    if (truth) truth->push_back(x);
    all.push_back({dt_s, x[0] + kSigma_m * random.normal()});
  }
  return all;
}

struct Passes {
  std::vector<ModeEstimates> filtered, smoothed;  // at each look
};

Passes both_ways(TrackedState& state, const std::vector<Look>& all) {
  Passes passes;
  StateUpdate update;
  for (const Look& look : all) {
    EXPECT_EQ(state.predict(look.dt_s), StepStatus::ok);
    EXPECT_EQ(state.update(ErasedMeasurement<Position<1>>(kSensor, Vector1(look.z_m), true), update), StepStatus::ok);
    passes.filtered.push_back(estimates_of(state));
  }
  BackwardStep backward(state);
  passes.smoothed = passes.filtered;
  for (std::size_t k = all.size() - 1; k-- > 0;) {
    const auto smoothed = backward.smoothed(passes.filtered[k], all[k + 1].dt_s, passes.smoothed[k + 1]);
    EXPECT_TRUE(smoothed.has_value());
    if (smoothed) passes.smoothed[k] = *smoothed;
  }
  return passes;
}

Passes both_ways(std::unique_ptr<TrackedState> state, const std::vector<Look>& all) {
  state->begin(kX0.data(), kP0.data());
  return both_ways(*state, all);
}

void expect_near(const ModeEstimate& a, const ModeEstimate& b, double tolerance) {
  EXPECT_LE((a.x - b.x).norm(), tolerance * (1.0 + b.x.norm()));
  EXPECT_LE((a.P - b.P).norm(), tolerance * b.P.norm());
}

void expect_same(const Passes& a, const Passes& b, double tolerance) {
  ASSERT_EQ(a.smoothed.size(), b.smoothed.size());
  for (std::size_t k = 0; k < a.smoothed.size(); ++k)
    expect_near(mixture_of(a.smoothed[k]), mixture_of(b.smoothed[k]), tolerance);
}

std::unique_ptr<InteractingMultipleModel> multiple(InteractingMultipleModel::Modes modes, MarkovChain chain) {
  return std::make_unique<InteractingMultipleModel>(std::move(modes), std::move(chain));
}

std::unique_ptr<InteractingMultipleModel> two_modes(double quiet, double lively, const MarkovChain& chain) {
  InteractingMultipleModel::Modes modes;
  modes.push_back(state_of<KalmanFilter<2>>(Cv{{quiet}}));
  modes.push_back(state_of<KalmanFilter<2>>(Cv{{lively}}));
  return multiple(std::move(modes), chain);
}

// All states at once, by least squares: prior, motions and measurements as information.
TEST(BackwardStep, OfALinearFilterIsTheBatchLeastSquares) {
  const Cv motion{{0.5}};
  const std::vector<Look> all = looks(motion, 0, 40);
  const Passes passes = both_ways(state_of<KalmanFilter<2>>(motion), all);
  const auto n = static_cast<Eigen::Index>(2 * all.size());
  Eigen::MatrixXd J = Eigen::MatrixXd::Zero(n, n);
  Eigen::VectorXd y = Eigen::VectorXd::Zero(n);
  const auto add = [&](Eigen::Index row, const Eigen::MatrixXd& A, const Eigen::MatrixXd& P, const Eigen::VectorXd& b) {
    const Eigen::MatrixXd W = Eigen::LLT<Eigen::MatrixXd>(P).solve(A);
    J.block(row, row, A.cols(), A.cols()) += A.transpose() * W;
    y.segment(row, A.cols()) += W.transpose() * b;
  };
  const Eigen::Matrix2d first = motion.F(all[0].dt_s);
  add(0, Eigen::Matrix2d::Identity(), first * kP0 * first.transpose() + motion.Q(all[0].dt_s), first * kX0);
  for (std::size_t k = 0; k < all.size(); ++k) {
    const auto row = static_cast<Eigen::Index>(2 * k);
    add(row, Eigen::RowVector2d(1.0, 0.0), Vector1(kSigma_m * kSigma_m), Vector1(all[k].z_m));
    if (k + 1 == all.size()) break;
    Eigen::Matrix<double, 2, 4> A;
    A << -Eigen::Matrix2d(motion.F(all[k + 1].dt_s)), Eigen::Matrix2d::Identity();
    add(row, A, motion.Q(all[k + 1].dt_s), Eigen::Vector2d::Zero());
  }
  const Eigen::LLT<Eigen::MatrixXd> factors(J);
  const Eigen::VectorXd x = factors.solve(y);
  const Eigen::MatrixXd P = factors.solve(Eigen::MatrixXd::Identity(n, n));
  for (std::size_t k = 0; k < all.size(); ++k) {
    const auto row = static_cast<Eigen::Index>(2 * k);
    expect_near(passes.smoothed[k].modes[0], {x.segment(row, 2), P.block(row, row, 2, 2)}, kManySteps);
  }
}

TEST(BackwardStep, OfEveryFilterOnALinearMotionIsTheSame) {
  const Cv motion{{0.5}};
  const std::vector<Look> all = looks(motion, 1, 60);
  const Passes expected = both_ways(state_of<KalmanFilter<2>>(motion), all);
  expect_same(both_ways(state_of<KalmanFilter<2, SquareRoot>>(motion), all), expected, kManySteps);
  expect_same(both_ways(state_of<KalmanFilter<2, Conventional>>(motion), all), expected, kManySteps);
  expect_same(both_ways(state_of<KalmanFilter<2>>(AsNonlinear<Cv>{motion}), all), expected, kManySteps);
  expect_same(both_ways(state_of<UnscentedKalmanFilter<2>>(motion), all), expected, kManySteps);
  expect_same(both_ways(state_of<UnscentedKalmanFilter<2>>(AsNonlinear<Cv>{motion}), all), expected, kManySteps);
}

TEST(BackwardStep, KnowsNoLessThanTheFilter) {
  for (std::uint64_t run = 0; run < 20; ++run) {
    const Cv motion{{0.01 * std::pow(2.0, static_cast<double>(run))}};
    const Passes passes = both_ways(state_of<KalmanFilter<2>>(motion), looks(motion, run, 40));
    for (std::size_t k = 0; k < passes.smoothed.size(); ++k) {
      const BoundedMatrix &P = passes.filtered[k].modes[0].P, &P_s = passes.smoothed[k].modes[0].P;
      EXPECT_TRUE(is_covariance(BoundedMatrix(P - P_s))) << run << ", look " << k;
      EXPECT_TRUE(k + 1 == passes.smoothed.size() || P_s.trace() < P.trace()) << run << ", look " << k;
    }
  }
}

// Of the middle of a run, of runs that are independent.
double summed_nees(double q_assumed, int runs) {
  const Cv motion{{0.5}};
  double sum = 0.0;
  for (int run = 0; run < runs; ++run) {
    std::vector<Eigen::Vector2d> truth;
    const std::vector<Look> all = looks(motion, static_cast<std::uint64_t>(run), 21, &truth);
    const ModeEstimate middle = both_ways(state_of<KalmanFilter<2>>(Cv{{q_assumed}}), all).smoothed[10].modes[0];
    sum += mahalanobis_squared(middle.P, BoundedVector(truth[10] - middle.x));
  }
  return sum;
}

TEST(BackwardStep, IsAsSureAsItMayBe) {
  constexpr int kRuns = 1000;
  const double matched = summed_nees(0.5, kRuns);
  EXPECT_FALSE(testing::is_too_small(matched, 2.0 * kRuns)) << matched;
  EXPECT_FALSE(testing::is_too_large(matched, 2.0 * kRuns)) << matched;
  EXPECT_TRUE(testing::is_too_large(summed_nees(0.2, kRuns), 2.0 * kRuns)) << "a motion that is taken for quieter";
  EXPECT_TRUE(testing::is_too_small(summed_nees(1.5, kRuns), 2.0 * kRuns)) << "or livelier";
}

TEST(BackwardStep, OfAMultipleModelThatStaysInOneModeIsThatModes) {
  const std::vector<Look> all = looks(Cv{{0.5}}, 3, 40);
  const MarkovChain stays{ModeMatrix::Identity(2, 2), ModeVector::Unit(2, 1), 1.0};
  expect_same(both_ways(two_modes(20.0, 0.5, stays), all), both_ways(state_of<KalmanFilter<2>>(Cv{{0.5}}), all),
              kManySteps);
}

TEST(BackwardStep, OfModesOfOneModelIsThatModels) {
  const std::vector<Look> all = looks(Cv{{0.5}}, 4, 40);
  expect_same(both_ways(two_modes(0.5, 0.5, star_chain(2, 0.2, 0.3, 1.0, 1.0)), all),
              both_ways(state_of<KalmanFilter<2>>(Cv{{0.5}}), all), 1e-7);
}

TEST(BackwardStep, OfUnequalModesThatStayIsThatModes) {
  const std::vector<Look> all = looks(Cv{{0.5}}, 5, 40);
  const Eigen::Vector3d x0(10.0, 3.0, 0.0), variance(100.0, 25.0, 1.0);
  const Eigen::Matrix3d P0 = variance.asDiagonal();
  for (const Eigen::Index mode : {0, 1}) {
    InteractingMultipleModel::Modes modes;
    modes.push_back(state_of<KalmanFilter<2>>(Cv{{0.5}}));
    modes.push_back(state_of<KalmanFilter<3>>(Ca{{0.1}}));
    const auto imm = multiple(std::move(modes), {ModeMatrix::Identity(2, 2), ModeVector::Unit(2, mode), 1.0});
    imm->begin(x0.data(), P0.data());
    const auto alone = mode == 0 ? state_of<KalmanFilter<2>>(Cv{{0.5}}) : state_of<KalmanFilter<3>>(Ca{{0.1}});
    const BoundedMatrix beginning = P0.topLeftCorner(alone->size(), alone->size());
    alone->begin(x0.data(), beginning.data());
    const Passes passes = both_ways(*imm, all), expected = both_ways(*alone, all);
    for (std::size_t k = 0; k < all.size(); ++k)
      expect_near(passes.smoothed[k].modes[static_cast<std::size_t>(mode)], expected.smoothed[k].modes[0], kManySteps);
  }
}

// What is known of the state at each look under every sequence of modes, with the probability of each.
class Sequences {
 public:
  Sequences(const std::vector<double>& qs, const MarkovChain& chain, const std::vector<Look>& all) {
    std::vector<std::size_t> sequence(all.size());
    const auto next = [&] {
      for (std::size_t& mode : sequence) {
        if (++mode < qs.size()) return true;
        mode = 0;
      }
      return false;
    };
    do {
      add(qs, chain, all, sequence);
    } while (next());
    double total = 0.0;
    for (const double weight : weights_) total += weight;
    for (double& weight : weights_) weight /= total;
  }

  ModeEstimate smoothed(std::size_t k) const {
    ModeEstimate all{BoundedVector::Zero(2), BoundedMatrix::Zero(2, 2)};
    for (std::size_t s = 0; s < weights_.size(); ++s) all.x += weights_[s] * parts_[s][k].x;
    for (std::size_t s = 0; s < weights_.size(); ++s) {
      const BoundedVector d = parts_[s][k].x - all.x;
      all.P += weights_[s] * (parts_[s][k].P + d * d.transpose());
    }
    return all;
  }

 private:
  void add(const std::vector<double>& qs, const MarkovChain& chain, const std::vector<Look>& all,
           const std::vector<std::size_t>& sequence) {
    std::vector<std::unique_ptr<TrackedState>> modes;
    for (const double q : qs) modes.push_back(state_of<KalmanFilter<2>>(Cv{{q}}));
    ModeEstimate now{kX0, kP0};
    std::vector<ModeEstimate> filtered;
    double log_weight = 0.0;
    ModeVector mu = chain.initial;
    for (std::size_t k = 0; k < all.size(); ++k) {
      TrackedState& state = *modes[sequence[k]];
      state.begin(now.x.data(), now.P.data());
      state.predict(all[k].dt_s);
      StateUpdate update;
      state.update(ErasedMeasurement<Position<1>>(kSensor, Vector1(all[k].z_m), true), update);
      now = {state.x(), state.P()};
      filtered.push_back(now);
      const ModeVector to = chain.over(all[k].dt_s).transpose() * mu;
      log_weight += std::log(to[static_cast<Eigen::Index>(sequence[k])]) + log_density(update.S, update.nu);
      mu = ModeVector::Unit(mu.size(), static_cast<Eigen::Index>(sequence[k]));
    }
    for (std::size_t k = all.size() - 1; k-- > 0;) {
      const ModeEstimates one{{filtered[k]}, ModeVector::Ones(1)}, after{{filtered[k + 1]}, ModeVector::Ones(1)};
      filtered[k] = BackwardStep(*modes[sequence[k + 1]]).smoothed(one, all[k + 1].dt_s, after)->modes[0];
    }
    parts_.push_back(std::move(filtered));
    weights_.push_back(std::exp(log_weight));
  }

  std::vector<std::vector<ModeEstimate>> parts_;  // [sequence][look]
  std::vector<double> weights_;
};

// One step back from a first measurement nothing has been mixed yet: there the smoother is exact.
TEST(BackwardStep, OfAMultipleModelIsExactWhereTheFilterIs) {
  const MarkovChain chain = star_chain(2, 0.1, 0.3, 1.0, 1.0);
  const std::vector<Look> all = looks(Cv{{8.0}}, 6, 1);
  const auto imm = two_modes(0.1, 30.0, chain);
  imm->begin(kX0.data(), kP0.data());
  const ModeEstimates before = estimates_of(*imm);
  const Passes passes = both_ways(*imm, all);
  const auto smoothed = BackwardStep(*imm).smoothed(before, all[0].dt_s, passes.filtered[0]);
  ASSERT_TRUE(smoothed.has_value());
  std::vector<ModeEstimate> parts;
  for (std::size_t j = 0; j < 2; ++j) {
    const ModeEstimates one{{{kX0, kP0}}, ModeVector::Ones(1)};
    const ModeEstimates after{{passes.filtered[0].modes[j]}, ModeVector::Ones(1)};
    const auto mode = state_of<KalmanFilter<2>>(Cv{{j == 0 ? 0.1 : 30.0}});
    parts.push_back(BackwardStep(*mode).smoothed(one, all[0].dt_s, after)->modes[0]);
  }
  expect_near(mixture_of(*smoothed), mixture_of({parts, passes.filtered[0].mu}), 1e-9);
}

// Beside all 2^9 sequences of modes: what the smoother misses of what looking back gives.
TEST(BackwardStep, OfAMultipleModelComesNearToAllSequences) {
  const MarkovChain chain = star_chain(2, 0.1, 0.3, 1.0, 1.0);
  double missed = 0.0, gained = 0.0, spread = 0.0, exact_spread = 0.0;
  for (std::uint64_t run = 0; run < 12; ++run) {
    const std::vector<Look> all = looks(Cv{{run % 2 == 0 ? 0.1 : 30.0}}, run, 9);
    const Sequences sequences({0.1, 30.0}, chain, all);
    const Passes passes = both_ways(two_modes(0.1, 30.0, chain), all);
    for (std::size_t k = 0; k + 1 < all.size(); ++k) {
      const ModeEstimate exact = sequences.smoothed(k), smoothed = mixture_of(passes.smoothed[k]);
      missed += mahalanobis_squared(exact.P, BoundedVector(smoothed.x - exact.x));
      gained += mahalanobis_squared(exact.P, BoundedVector(mixture_of(passes.filtered[k]).x - exact.x));
      spread += smoothed.P.trace();
      exact_spread += exact.P.trace();
    }
  }
  EXPECT_LT(missed, 0.05 * gained);
  EXPECT_NEAR(spread, exact_spread, 0.05 * exact_spread);
}

// Of targets that change between a quiet and a lively motion as the chain says, in the middle of a run.
double summed_nees_of_modes(double lively_assumed, int runs) {
  const MarkovChain chain = star_chain(2, 0.1, 0.3, 1.0, 1.0);
  const std::array<Cv, 2> motions{Cv{{0.1}}, Cv{{30.0}}};
  double sum = 0.0;
  for (int run = 0; run < runs; ++run) {
    RandomStream random({72, Role::evaluation, static_cast<std::uint64_t>(run)}, StreamId::test);
    const auto draw = [&](const Eigen::Matrix2d& P) {
      Eigen::Vector2d unit;
      for (double& value : unit) value = random.normal();
      return Eigen::Vector2d(Eigen::LLT<Eigen::Matrix2d>(P).matrixL() * unit);
    };
    Eigen::Vector2d x = kX0 + draw(kP0), middle;
    std::size_t mode = random.uniform() < chain.initial[0] ? 0 : 1;
    std::vector<Look> all;
    for (int k = 0; k < 21; ++k) {
      mode = random.uniform() < chain.transition(static_cast<Eigen::Index>(mode), 0) ? 0 : 1;
      x = motions[mode].F(1.0) * x + draw(motions[mode].Q(1.0));
      if (k == 10) middle = x;
      all.push_back({1.0, x[0] + kSigma_m * random.normal()});
    }
    const ModeEstimate smoothed = mixture_of(both_ways(two_modes(0.1, lively_assumed, chain), all).smoothed[10]);
    sum += mahalanobis_squared(smoothed.P, BoundedVector(middle - smoothed.x));
  }
  return sum;
}

// With that many runs an error of a fifth in its covariance is beyond chance.
TEST(BackwardStep, OfAMultipleModelIsAsSureAsItMayBe) {
  constexpr int kRuns = 600;
  const double matched = summed_nees_of_modes(30.0, kRuns);
  EXPECT_FALSE(testing::is_too_small(matched, 2.0 * kRuns)) << matched;
  EXPECT_FALSE(testing::is_too_large(matched, 2.0 * kRuns)) << matched;
  EXPECT_TRUE(testing::is_too_large(summed_nees_of_modes(3.0, kRuns), 2.0 * kRuns)) << "manoeuvres taken for smaller";
}

TEST(BackwardStep, OverNoTimeIsTheLaterEstimate) {
  const auto state = state_of<KalmanFilter<2>>(Cv{{0.5}});
  const ModeEstimates filtered{{{kX0, kP0}}, ModeVector::Ones(1)};
  const ModeEstimates next{{{2.0 * kX0, 0.5 * kP0}}, ModeVector::Ones(1)};
  const auto smoothed = BackwardStep(*state).smoothed(filtered, 0.0, next);
  ASSERT_TRUE(smoothed.has_value());
  EXPECT_EQ(smoothed->modes[0].x, next.modes[0].x);
  EXPECT_EQ(smoothed->modes[0].P, next.modes[0].P);
}

// A gate that widens P_pred supposes more noise of the motion, which is then not smoothed away.
TEST(BackwardStep, AWidenedPredictionIsAMotionOfMoreNoise) {
  const Cv motion{{0.5}};
  const ModeEstimates filtered{{{kX0, kP0}}, ModeVector::Ones(1)};
  const Eigen::Matrix2d F = motion.F(1.0), P_pred = F * kP0 * F.transpose() + motion.Q(1.0);
  const LinearMotion<2> noisier{F, motion.Q(1.0) + 2.0 * P_pred};
  const ModeEstimates next{{{F * kX0 + Eigen::Vector2d(5.0, 1.0), 0.3 * P_pred}}, ModeVector::Ones(1)};
  const auto widened = BackwardStep(*state_of<KalmanFilter<2>>(motion)).smoothed(filtered, 1.0, next, 3.0);
  const auto expected = BackwardStep(*state_of<KalmanFilter<2>>(noisier)).smoothed(filtered, 1.0, next);
  expect_near(widened->modes[0], expected->modes[0], kManySteps);
}

TEST(BackwardStep, WhatIsNoCovarianceIsNotGiven) {
  const auto state = state_of<KalmanFilter<2>>(Cv{{0.5}});
  const ModeEstimates filtered{{{kX0, kP0}}, ModeVector::Ones(1)};
  const ModeEstimates impossible{{{kX0, -1e4 * kP0}}, ModeVector::Ones(1)};
  EXPECT_FALSE(BackwardStep(*state).smoothed(filtered, 1.0, impossible).has_value());
  EXPECT_FALSE(BackwardStep(*state).smoothed({{{kX0, -kP0}}, ModeVector::Ones(1)}, 1.0, filtered).has_value());
}

}  // namespace
}  // namespace truebearing::backward_step_test
