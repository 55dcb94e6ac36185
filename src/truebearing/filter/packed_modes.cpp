// SPDX-License-Identifier: Apache-2.0
#include "truebearing/filter/packed_modes.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <type_traits>
#include <utility>

#include "truebearing/core/constants.hpp"
#include "truebearing/core/with_count.hpp"
#include "truebearing/filter/filter_kinds.hpp"
#include "truebearing/filter/packed_modes_kernel.hpp"
#include "truebearing/filter/separate_modes.hpp"

namespace truebearing {
namespace {

// The longest states and measurements that the kernels are compiled for.
constexpr int most_measurements(int states) {
  return states == 2 ? 2 : states == 4 ? 3 : 4;
}

template <int N>
class PackedModes final : public ModeBank {
  using Motion = SizedMotion<N>;
  using State = Eigen::Matrix<double, N, 1>;
  using Matrix = Eigen::Matrix<double, N, N>;
  using Shell = FilterState<KalmanFilter<N>>;

 public:
  explicit PackedModes(std::vector<std::shared_ptr<const Motion>> motions)
      : motions_(std::move(motions)),
        modes_(static_cast<std::size_t>(blocks())),
        next_(modes_.size()),
        transitions_(modes_.size()),
        updates_(modes_.size()),
        verdicts_(modes_.size()),
        weights_(modes_.size() * motions_.size()) {
    nonlinear_.reserve(modes_.size() * kLanes);
    for (const auto& motion : motions_) shells_.push_back(std::make_unique<Shell>(motion));
    const Matrix P = Matrix::Identity();
    begin(State::Zero().eval().data(), P.data(), N);
  }

  void begin(const double* x, const double* P, int) override {
    const KalmanFilter<N> filter(matrix_at<N, 1>(x), matrix_at<N, N>(P));
    for (kernels::ModeBlock<N>& block : modes_)
      for (int lane = 0; lane < kLanes; ++lane) set(block, lane, filter.x(), filter.P());
  }

  bool mix_and_predict(const ModeMatrix& weights, double dt_s) override {
    for (int from = 0; from < count(); ++from)
      for (int lane = 0; lane < blocks() * kLanes; ++lane)
        weights_[static_cast<std::size_t>(from * blocks() + lane / kLanes)].of_mode[lane % kLanes] =
            weights(from, mode_at(lane));
    kernels::mix_modes<N>(modes_.data(), count(), weights_.data(), blocks(), next_.data());
    find_transitions(dt_s);
    kernels::predict_modes<N>(transitions_.data(), blocks(), next_.data(), verdicts_.data());
    for (const Moved& moved : nonlinear_)
      for (int i = 0; i < N; ++i)
        next_[static_cast<std::size_t>(moved.lane / kLanes)].x[i][moved.lane % kLanes] = moved.x[i];
    for (int lane = 0; lane < count(); ++lane)
      if (!is_valid(lane)) return false;
    modes_.swap(next_);
    return true;
  }

  void update(const AnyMeasurement& measurement, ModeVector& log_likelihood) override {
    with_length(measurement, [&]<int M>(const SizedMeasurement<M>& sized) {
      if constexpr (M <= most_measurements(N)) {
        take(sized, log_likelihood);
      } else {
        measured_ = M;
        log_likelihood = ModeVector::Constant(count(), -kInfinity);
      }
    });
  }

  void keep() override { modes_.swap(next_); }

  void mix_innovations(const ModeVector& weights, BoundedVector& nu, BoundedMatrix& S) const override {
    nu.setZero(measured_);
    S.setZero(measured_, measured_);
    for (int mode = 0; mode < count(); ++mode)
      if (weights[mode] > 0.0)
        for (int m = 0; m < measured_; ++m) nu[m] += weights[mode] * update_of(mode).nu[m][mode % kLanes];
    for (int mode = 0; mode < count(); ++mode) {
      if (!(weights[mode] > 0.0)) continue;
      const kernels::UpdateBlock<N>& update = update_of(mode);
      const int lane = mode % kLanes;
      for (int col = 0; col < measured_; ++col)
        for (int row = 0; row < measured_; ++row)
          S(row, col) += weights[mode] * (update.S[row][col][lane] +
                                          (update.nu[row][lane] - nu[row]) * (update.nu[col][lane] - nu[col]));
    }
  }

  void mix_gains(const ModeVector& weights, BoundedMatrix& K) const override {
    K.setZero(N, measured_);
    for (int mode = 0; mode < count(); ++mode)
      if (weights[mode] > 0.0)
        for (int m = 0; m < measured_; ++m)
          for (int i = 0; i < N; ++i) K(i, m) += weights[mode] * update_of(mode).K[i][m][mode % kLanes];
  }

  void mix(const ModeVector& weights, double* x, double* P) const override {
    kernels::LaneWeights of_lanes[kMaxModes / kLanes + 1]{};
    for (int mode = 0; mode < count(); ++mode) of_lanes[mode / kLanes].of_mode[mode % kLanes] = weights[mode];
    kernels::mix_to_one<N>(modes_.data(), of_lanes, blocks(), x, P);
  }

  void assign(const ModeBank& other) override { modes_ = static_cast<const PackedModes&>(other).modes_; }
  std::unique_ptr<ModeBank> fresh() const override { return std::make_unique<PackedModes>(motions_); }

  std::span<const std::unique_ptr<TrackedState>> modes() const override {
    for (int mode = 0; mode < count(); ++mode) {
      const auto [x, P] = at(modes_, mode);
      shells_[static_cast<std::size_t>(mode)]->begin(x.data(), P.data());
    }
    return shells_;
  }

 private:
  using Blocks = std::vector<kernels::ModeBlock<N>>;
  struct Estimate {
    State x;
    Matrix P;
  };
  struct Moved {
    int lane;
    State x;
  };

  int count() const { return static_cast<int>(motions_.size()); }
  int blocks() const { return padded_to_lanes(count()) / kLanes; }
  // Lanes behind the last mode repeat it.
  int mode_at(int lane) const { return std::min(lane, count() - 1); }
  const kernels::UpdateBlock<N>& update_of(int mode) const { return updates_[static_cast<std::size_t>(mode / kLanes)]; }

  static void set(kernels::ModeBlock<N>& block, int lane, const State& x, const Matrix& P) {
    for (int i = 0; i < N; ++i) {
      block.x[i][lane] = x[i];
      for (int j = 0; j < N; ++j) block.P[i][j][lane] = P(i, j);
    }
  }

  static Estimate at(const Blocks& blocks, int lane) {
    const kernels::ModeBlock<N>& block = blocks[static_cast<std::size_t>(lane / kLanes)];
    Estimate estimate;
    for (int i = 0; i < N; ++i) {
      estimate.x[i] = block.x[i][lane % kLanes];
      for (int j = 0; j < N; ++j) estimate.P(i, j) = block.P[i][j][lane % kLanes];
    }
    return estimate;
  }

  // F and Q of every lane. Those of linear motions stand as long as dt_s does.
  void find_transitions(double dt_s) {
    nonlinear_.clear();
    for (int lane = 0; lane < blocks() * kLanes; ++lane) {
      const Motion& motion = *motions_[static_cast<std::size_t>(mode_at(lane))];
      if (motion.is_linear() && dt_s == transition_dt_s_) continue;
      State x = State::Zero();
      if (!motion.is_linear()) {
        x = at(next_, lane).x;
        nonlinear_.push_back({lane, motion.f(x, dt_s)});
      }
      const Matrix F = motion.F(x, dt_s), Q = motion.Q(dt_s);
      kernels::TransitionBlock<N>& block = transitions_[static_cast<std::size_t>(lane / kLanes)];
      for (int i = 0; i < N; ++i)
        for (int j = 0; j < N; ++j) {
          block.F[i][j][lane % kLanes] = F(i, j);
          block.Q[i][j][lane % kLanes] = Q(i, j);
        }
    }
    transition_dt_s_ = dt_s;
  }

  // Of next_: x finite, P positive semi-definite.
  bool is_valid(int lane) const {
    const kernels::ModeBlock<N>& block = next_[static_cast<std::size_t>(lane / kLanes)];
    bool valid = true;
    for (int i = 0; i < N; ++i) valid &= block.x[i][lane % kLanes] - block.x[i][lane % kLanes] == 0.0;
    if (!valid || verdicts_[static_cast<std::size_t>(lane / kLanes)].plainly[lane % kLanes]) return valid;
    return is_positive_semidefinite<N, double>(at(next_, lane).P);
  }

  template <int M>
  void take(const SizedMeasurement<M>& measurement, ModeVector& log_likelihood) {
    measured_ = M;
    next_ = modes_;
    for (int lane = 0; lane < blocks() * kLanes; ++lane) look(measurement, lane);
    if (measurement.is_position())
      kernels::update_modes<N, M, true>(measurement.R.data(), blocks(), next_.data(), updates_.data(),
                                        verdicts_.data());
    else
      kernels::update_modes<N, M, false>(measurement.R.data(), blocks(), next_.data(), updates_.data(),
                                         verdicts_.data());
    const bool has_R = is_positive_semidefinite<M, double>(measurement.R);
    log_likelihood.resize(count());
    for (int mode = 0; mode < count(); ++mode) {
      const kernels::UpdateBlock<N>& update = update_of(mode);
      const int lane = mode % kLanes;
      const double gained =
          -0.5 * (update.nis[lane] + std::log(update.determinant[lane]) + M * std::log(2.0 * std::numbers::pi));
      const bool valid = has_R && update.has_gain[lane] && std::isfinite(gained) && is_valid(mode);
      log_likelihood[mode] = valid ? gained : -kInfinity;
    }
    for (int lane = 0; lane < blocks() * kLanes; ++lane) {
      if (log_likelihood[mode_at(lane)] > -kInfinity) continue;
      const auto [x, P] = at(modes_, lane);  // what failed stays as it was
      set(next_[static_cast<std::size_t>(lane / kLanes)], lane % kLanes, x, P);
    }
  }

  // The innovation of a lane and, unless a position is measured, its H.
  template <int M>
  void look(const SizedMeasurement<M>& measurement, int lane) {
    const int block = lane / kLanes, place = lane % kLanes;
    kernels::UpdateBlock<N>& update = updates_[static_cast<std::size_t>(block)];
    const kernels::ModeBlock<N>& mode = modes_[static_cast<std::size_t>(block)];
    if (measurement.is_position()) {
      for (int m = 0; m < M; ++m) update.nu[m][place] = measurement.z[m] - mode.x[m][place];
      return;
    }
    State x;
    for (int i = 0; i < N; ++i) x[i] = mode.x[i][place];
    const MeasurementOn<N, M> model{measurement};
    const Eigen::Matrix<double, M, 1> nu = model.residual(measurement.z, model.h(x));
    const Eigen::Matrix<double, M, N> H = model.H(x);
    for (int m = 0; m < M; ++m) {
      update.nu[m][place] = nu[m];
      for (int i = 0; i < N; ++i) update.H[m][i][place] = H(m, i);
    }
  }

  std::vector<std::shared_ptr<const Motion>> motions_;
  Blocks modes_;
  Blocks next_;  // what the modes are to become, until all of them have
  std::vector<kernels::TransitionBlock<N>> transitions_;
  double transition_dt_s_ = kNaN;
  std::vector<Moved> nonlinear_;  // f(x) of the modes whose motion is
  std::vector<kernels::UpdateBlock<N>> updates_;
  std::vector<kernels::LaneVerdicts> verdicts_;
  std::vector<kernels::LaneWeights> weights_;
  int measured_ = 1;  // m of the last update
  Modes shells_;      // the modes as filters of their own
};

template <int N>
std::unique_ptr<ModeBank> packed(const ModeBank::Modes& modes) {
  std::vector<std::shared_ptr<const SizedMotion<N>>> motions;
  for (const auto& mode : modes) {
    const auto* filter = dynamic_cast<const FilterState<KalmanFilter<N>>*>(mode.get());
    if (!filter) return nullptr;
    motions.push_back(filter->motion());
  }
  return std::make_unique<PackedModes<N>>(std::move(motions));
}

}  // namespace

std::unique_ptr<ModeBank> packed_modes(const ModeBank::Modes& modes) {
  std::unique_ptr<ModeBank> bank;
  if (modes.size() < 2) return bank;
  with_count(modes.front()->size(), [&]<int N>(std::integral_constant<int, N>) {
    if constexpr (N == 2 || N == 4 || N == 6) bank = packed<N>(modes);
  });
  return bank;
}

std::unique_ptr<ModeBank> bank_of(ModeBank::Modes modes) {
  if (std::unique_ptr<ModeBank> packed = packed_modes(modes)) return packed;
  return std::make_unique<SeparateModes>(std::move(modes));
}

}  // namespace truebearing
