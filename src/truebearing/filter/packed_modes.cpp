// SPDX-License-Identifier: Apache-2.0
#include "truebearing/filter/packed_modes.hpp"

#include <algorithm>
#include <array>
#include <type_traits>
#include <utility>

#include "truebearing/core/constants.hpp"
#include "truebearing/core/covariance.hpp"
#include "truebearing/core/with_count.hpp"
#include "truebearing/filter/filter_kinds.hpp"
#include "truebearing/filter/packed_mixtures_kernel.hpp"
#include "truebearing/filter/separate_modes.hpp"

namespace truebearing {
namespace {

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
        good_(modes_.size()),
        weights_(modes_.size() * motions_.size()) {
    nonlinear_.reserve(modes_.size() * kernels::kBlock);
    for (const auto& motion : motions_) {
      shells_.push_back(std::make_unique<Shell>(motion));
      all_linear_ &= motion->is_linear();
    }
    const Matrix P = Matrix::Identity();
    begin(State::Zero().eval().data(), P.data(), N);
  }

  void begin(const double* x, const double* P, int) override {
    const KalmanFilter<N> filter(matrix_at<N, 1>(x), matrix_at<N, N>(P));
    for (int lane = 0; lane < lanes(); ++lane) set(modes_, lane, filter.x(), filter.P());
  }

  void begin_mode(int mode, const double* x, const double* P) override {
    const KalmanFilter<N> filter(matrix_at<N, 1>(x), matrix_at<N, N>(P));
    for (int lane = mode; lane < (mode + 1 < count() ? mode + 1 : lanes()); ++lane)
      set(modes_, lane, filter.x(), filter.P());
  }

  bool mix_and_predict(const ModeMatrix& weights, double dt_s) override {
    for (int to = 0; to < lanes(); ++to) {
      const double* of_all = weights.data() + mode_at(to) * weights.rows();
      kernels::OfFilters* in_block = weights_.data() + to / kernels::kBlock;
      for (int from = 0; from < count(); ++from) in_block[from * blocks()][to % kernels::kBlock] = of_all[from];
    }
    kernels::mix_modes<N>(modes_.data(), count(), weights_.data(), next_.data());
    find_transitions(dt_s);
    kernels::predict_filters<N>(transitions_.data(), count(), next_.data(), next_.data(), good_.data());
    for (const Moved& moved : nonlinear_) {
      if (!is_finite(moved.x)) block_of(good_, moved.lane).lane[moved.lane % kernels::kBlock] = 0;
      for (int i = 0; i < N; ++i) block_of(next_, moved.lane).x[i][moved.lane % kernels::kBlock] = moved.x[i];
    }
    for (int lane = 0; lane < count(); ++lane)
      if (!is_valid(lane)) return false;
    modes_.swap(next_);
    return true;
  }

  void update(const AnyMeasurement& measurement, ModeVector& log_likelihood) override {
    with_length(measurement, [&]<int M>(const SizedMeasurement<M>& sized) {
      if constexpr (M <= kernels::most_measurements(N)) {
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
    with_measured([&]<int M>(std::integral_constant<int, M>) {
      kernels::mix_innovations<N, M>(updates_.data(), count(), of_lanes(weights).data(), nu.data(), S.data());
    });
  }

  void mix_gains(const ModeVector& weights, BoundedMatrix& K) const override {
    K.setZero(N, measured_);
    with_measured([&]<int M>(std::integral_constant<int, M>) {
      kernels::mix_gains<N, M>(updates_.data(), count(), of_lanes(weights).data(), K.data());
    });
  }

  void mix(const ModeVector& weights, double* x, double* P) const override {
    kernels::mix_to_one<N>(modes_.data(), count(), of_lanes(weights).data(), x, P);
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
  using Blocks = std::vector<kernels::FilterBlock<N>>;
  struct Estimate {
    State x;
    Matrix P;
  };
  struct Moved {
    int lane;
    State x;
  };

  int count() const { return static_cast<int>(motions_.size()); }
  int blocks() const { return kernels::blocks_of(count()); }
  int lanes() const { return blocks() * kernels::kBlock; }
  // Lanes behind the last mode repeat it.
  int mode_at(int lane) const { return std::min(lane, count() - 1); }
  template <typename Block>
  static Block& block_of(std::vector<Block>& blocks, int lane) {
    return blocks[static_cast<std::size_t>(lane / kernels::kBlock)];
  }
  template <typename Block>
  static const Block& block_of(const std::vector<Block>& blocks, int lane) {
    return blocks[static_cast<std::size_t>(lane / kernels::kBlock)];
  }

  // No weight for lanes that repeat a mode.
  static std::array<kernels::OfFilters, kernels::blocks_of(kMaxModes)> of_lanes(const ModeVector& weights) {
    std::array<kernels::OfFilters, kernels::blocks_of(kMaxModes)> of_lanes{};
    for (int mode = 0; mode < weights.size(); ++mode)
      of_lanes[static_cast<std::size_t>(mode / kernels::kBlock)][mode % kernels::kBlock] = weights[mode];
    return of_lanes;
  }

  // body(std::integral_constant<int, m>()) of the last measurement, where it was one that can be taken.
  template <typename Body>
  void with_measured(const Body& body) const {
    with_count(measured_, [&]<int M>(std::integral_constant<int, M> m) {
      if constexpr (M > 0 && M <= kernels::most_measurements(N)) body(m);
    });
  }

  static void set(Blocks& blocks, int lane, const State& x, const Matrix& P) {
    kernels::FilterBlock<N>& block = block_of(blocks, lane);
    const int place = lane % kernels::kBlock;
    for (int i = 0; i < N; ++i) {
      block.x[i][place] = x[i];
      for (int j = 0; j < N; ++j) block.P[i][j][place] = P(i, j);
    }
  }

  static Estimate at(const Blocks& blocks, int lane) {
    const kernels::FilterBlock<N>& block = block_of(blocks, lane);
    const int place = lane % kernels::kBlock;
    Estimate estimate;
    for (int i = 0; i < N; ++i) {
      estimate.x[i] = block.x[i][place];
      for (int j = 0; j < N; ++j) estimate.P(i, j) = block.P[i][j][place];
    }
    return estimate;
  }

  // F and Q of every lane. Those of linear motions stand as long as dt_s does.
  void find_transitions(double dt_s) {
    nonlinear_.clear();
    if (all_linear_ && dt_s == transition_dt_s_) return;
    for (int lane = 0; lane < lanes(); ++lane) {
      const Motion& motion = *motions_[static_cast<std::size_t>(mode_at(lane))];
      if (motion.is_linear() && dt_s == transition_dt_s_) continue;
      State x = State::Zero();
      if (!motion.is_linear()) {
        x = at(next_, lane).x;
        nonlinear_.push_back({lane, motion.f(x, dt_s)});
      }
      const Matrix F = motion.F(x, dt_s), Q = motion.Q(dt_s);
      kernels::TransitionBlock<N>& block = block_of(transitions_, lane);
      for (int i = 0; i < N; ++i)
        for (int j = 0; j < N; ++j) {
          block.F[i][j][lane % kernels::kBlock] = F(i, j);
          block.Q[i][j][lane % kernels::kBlock] = Q(i, j);
        }
    }
    transition_dt_s_ = dt_s;
  }

  // Of next_: x finite, P positive semi-definite.
  bool is_valid(int mode) const {
    if (block_of(good_, mode)[mode % kernels::kBlock]) [[likely]]
      return true;
    const auto [x, P] = at(next_, mode);
    return is_finite(x) && is_positive_semidefinite<N, double>(P);
  }

  template <int M>
  void take(const SizedMeasurement<M>& measurement, ModeVector& log_likelihood) {
    measured_ = M;
    tell_R(measurement);
    if (measurement.is_position()) {
      tell_z(measurement);
      kernels::update_filters<N, M, true>(count(), modes_.data(), updates_.data(), next_.data(), good_.data());
    } else {
      for (int lane = 0; lane < lanes(); ++lane) look(measurement, lane);
      kernels::update_filters<N, M, false>(count(), modes_.data(), updates_.data(), next_.data(), good_.data());
    }
    const bool has_R = is_positive_semidefinite<M, double>(measurement.R);
    log_likelihood.resize(count());
    bool all_valid = true;
    for (int mode = 0; mode < count(); ++mode) {
      const kernels::UpdateBlock<N>& update = block_of(updates_, mode);
      const int place = mode % kernels::kBlock;
      const bool valid = has_R && update.has_gain[place] && is_valid(mode);
      log_likelihood[mode] = valid ? update.log_likelihood[place] : -kInfinity;
      all_valid &= valid;
    }
    if (all_valid) [[likely]]
      return;
    for (int lane = 0; lane < lanes(); ++lane) {
      if (log_likelihood[mode_at(lane)] > -kInfinity) continue;
      const auto [x, P] = at(modes_, lane);  // what failed stays as it was
      set(next_, lane, x, P);
      forget<M>(lane);
    }
  }

  // What a lane has no weight for may be no number.
  template <int M>
  void forget(int lane) {
    kernels::UpdateBlock<N>& update = block_of(updates_, lane);
    const int place = lane % kernels::kBlock;
    for (int m = 0; m < M; ++m) {
      update.nu[m][place] = 0.0;
      for (int l = 0; l < M; ++l) update.S[m][l][place] = 0.0;
      for (int i = 0; i < N; ++i) update.K[i][m][place] = 0.0;
    }
  }

  // z and R to every lane. An R that they have been told stands.
  template <int M>
  void tell_z(const SizedMeasurement<M>& measurement) {
    for (kernels::UpdateBlock<N>& update : updates_)
      for (int m = 0; m < M; ++m)
        for (double& z : update.nu[m].lane) z = measurement.z[m];
  }
  template <int M>
  void tell_R(const SizedMeasurement<M>& measurement) {
    const double* R = measurement.R.data();
    if (told_ == M && std::equal(R, R + M * M, told_R_.begin())) return;
    for (kernels::UpdateBlock<N>& update : updates_)
      for (int m = 0; m < M; ++m)
        for (int l = 0; l < M; ++l)
          for (double& lane : update.R[m][l].lane) lane = measurement.R(m, l);
    std::copy(R, R + M * M, told_R_.begin());
    told_ = M;
  }

  // The innovation of a lane and its H.
  template <int M>
  void look(const SizedMeasurement<M>& measurement, int lane) {
    kernels::UpdateBlock<N>& update = block_of(updates_, lane);
    const int place = lane % kernels::kBlock;
    const State x = at(modes_, lane).x;
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
  bool all_linear_ = true;
  std::vector<Moved> nonlinear_;  // f(x) of the modes whose motion is
  std::vector<kernels::UpdateBlock<N>> updates_;
  std::vector<kernels::FilterMask> good_;  // of next_
  std::vector<kernels::OfFilters> weights_;
  int told_ = 0;  // m of the R that updates_ have
  std::array<double, kMaxMeasurements * kMaxMeasurements> told_R_{};
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
