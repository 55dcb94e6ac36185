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
#include "truebearing/filter/packed_filters.hpp"
#include "truebearing/filter/packed_mixtures_kernel.hpp"
#include "truebearing/filter/separate_modes.hpp"

namespace truebearing {
namespace {

template <int N>
class PackedModes final : public ModeBank {
  using Motion = SizedMotion<N>;
  using State = Eigen::Matrix<double, N, 1>;
  using Covariance = Eigen::Matrix<double, N, N>;
  using Blocks = typename PackedFilters<N>::Blocks;
  using Shell = FilterState<KalmanFilter<N>>;

 public:
  explicit PackedModes(std::vector<std::shared_ptr<const Motion>> motions)
      : motions_(std::move(motions)),
        modes_(static_cast<std::size_t>(blocks())),
        next_(modes_.size()),
        filters_(modes_.size()),
        weights_(modes_.size() * motions_.size()) {
    for (const auto& motion : motions_) {
      shells_.push_back(std::make_unique<Shell>(motion));
      all_linear_ &= motion->is_linear();
    }
    const Covariance P = Covariance::Identity();
    begin(State::Zero().eval().data(), P.data(), N);
  }

  void begin(const double* x, const double* P, int) override { begin_lanes(0, lanes(), x, P); }
  void begin_mode(int mode, const double* x, const double* P) override { begin_lanes(mode, end_of(mode), x, P); }

  bool mix_and_predict(const ModeMatrix& weights, double dt_s) override {
    for (int to = 0; to < lanes(); ++to) {
      const double* of_all = weights.data() + mode_at(to) * weights.rows();
      kernels::OfFilters* in_block = weights_.data() + to / kernels::kBlock;
      for (int from = 0; from < count(); ++from) in_block[from * blocks()][kernels::lane_of(to)] = of_all[from];
    }
    kernels::mix_modes<N>(modes_.data(), count(), weights_.data(), next_.data());
    find_transitions(dt_s);
    filters_.predict(count(), next_, next_);
    for (int mode = 0; mode < count(); ++mode)
      if (!filters_.is_valid(mode, next_)) return false;
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
      kernels::mix_innovations<N, M>(filters_.updates().data(), count(), of_lanes(weights).data(), nu.data(), S.data());
    });
  }

  void mix_gains(const ModeVector& weights, BoundedMatrix& K) const override {
    K.setZero(N, measured_);
    with_measured([&]<int M>(std::integral_constant<int, M>) {
      kernels::mix_gains<N, M>(filters_.updates().data(), count(), of_lanes(weights).data(), K.data());
    });
  }

  void mix(const ModeVector& weights, double* x, double* P) const override {
    kernels::mix_to_one<N>(modes_.data(), count(), of_lanes(weights).data(), x, P);
  }

  void assign(const ModeBank& other) override { modes_ = static_cast<const PackedModes&>(other).modes_; }
  std::unique_ptr<ModeBank> fresh() const override { return std::make_unique<PackedModes>(motions_); }

  std::span<const std::unique_ptr<TrackedState>> modes() const override {
    for (int mode = 0; mode < count(); ++mode) {
      const kernels::FilterBlock<N>& block = kernels::block_of(modes_, mode);
      const int lane = kernels::lane_of(mode);
      shells_[static_cast<std::size_t>(mode)]->begin(block.x_of(lane).data(), block.P_of(lane).data());
    }
    return shells_;
  }

 private:
  int count() const { return static_cast<int>(motions_.size()); }
  int blocks() const { return kernels::blocks_of(count()); }
  // Those behind the last mode repeat it.
  int lanes() const { return kernels::lanes_of(count()); }
  int mode_at(int lane) const { return std::min(lane, count() - 1); }
  // Behind the lanes of a mode, of which the first has its number.
  int end_of(int mode) const { return mode + 1 < count() ? mode + 1 : lanes(); }

  void begin_lanes(int first, int end, const double* x, const double* P) {
    const KalmanFilter<N> filter(matrix_at<N, 1>(x), matrix_at<N, N>(P));
    for (int i = first; i < end; ++i) kernels::block_of(modes_, i).set(kernels::lane_of(i), filter.x(), filter.P());
  }

  // No weight for lanes that repeat a mode.
  static std::array<kernels::OfFilters, kernels::blocks_of(kMaxModes)> of_lanes(const ModeVector& weights) {
    std::array<kernels::OfFilters, kernels::blocks_of(kMaxModes)> of_lanes{};
    for (int mode = 0; mode < weights.size(); ++mode)
      of_lanes[static_cast<std::size_t>(mode / kernels::kBlock)][kernels::lane_of(mode)] = weights[mode];
    return of_lanes;
  }

  // body(std::integral_constant<int, m>()) of the last measurement, where it was one that can be taken.
  template <typename Body>
  void with_measured(const Body& body) const {
    with_count(measured_, [&]<int M>(std::integral_constant<int, M> m) {
      if constexpr (M > 0 && M <= kernels::most_measurements(N)) body(m);
    });
  }

  // F and Q of every mode. Those of linear motions stand as long as dt_s does.
  void find_transitions(double dt_s) {
    filters_.begin_transitions();
    if (all_linear_ && dt_s == transition_dt_s_) return;
    for (int mode = 0; mode < count(); ++mode) {
      const Motion& motion = *motions_[static_cast<std::size_t>(mode)];
      if (!motion.is_linear() || dt_s != transition_dt_s_)
        filters_.find_transition(motion, dt_s, mode, end_of(mode), next_);
    }
    transition_dt_s_ = dt_s;
  }

  template <int M>
  void take(const SizedMeasurement<M>& measurement, ModeVector& log_likelihood) {
    measured_ = M;
    tell_R(measurement);
    if (measurement.is_position())
      tell_z(measurement);
    else
      for (int mode = 0; mode < count(); ++mode) filters_.look(measurement, mode, end_of(mode), modes_);
    filters_.template update<M>(measurement.is_position(), count(), modes_, next_);
    const bool has_R = is_positive_semidefinite<M, double>(measurement.R);
    log_likelihood.resize(count());
    bool all_valid = true;
    for (int mode = 0; mode < count(); ++mode) {
      const kernels::UpdateBlock<N>& update = kernels::block_of(filters_.updates(), mode);
      const int lane = kernels::lane_of(mode);
      const bool valid = has_R && update.has_gain[lane] && filters_.is_valid(mode, next_);
      log_likelihood[mode] = valid ? update.log_likelihood[lane] : -kInfinity;
      all_valid &= valid;
    }
    if (all_valid) [[likely]]
      return;
    for (int i = 0; i < lanes(); ++i) {
      if (log_likelihood[mode_at(i)] > -kInfinity) continue;
      kernels::block_of(next_, i).copy(kernels::lane_of(i), kernels::block_of(modes_, i));  // stays as it was
      forget<M>(i);
    }
  }

  // What a lane has no weight for may be no number.
  template <int M>
  void forget(int i) {
    kernels::UpdateBlock<N>& update = kernels::block_of(filters_.updates(), i);
    const int lane = kernels::lane_of(i);
    kernels::set_lane(Eigen::Matrix<double, M, 1>::Zero(), lane, update.nu);
    kernels::set_lane(Eigen::Matrix<double, M, M>::Zero(), lane, update.S);
    kernels::set_lane(Eigen::Matrix<double, N, M>::Zero(), lane, update.K);
  }

  // z and R to every lane. An R that they have been told stands.
  template <int M>
  void tell_z(const SizedMeasurement<M>& measurement) {
    for (kernels::UpdateBlock<N>& update : filters_.updates())
      for (int m = 0; m < M; ++m)
        for (double& z : update.nu[m].lane) z = measurement.z[m];
  }
  template <int M>
  void tell_R(const SizedMeasurement<M>& measurement) {
    const double* R = measurement.R.data();
    if (told_ == M && std::equal(R, R + M * M, told_R_.begin())) return;
    for (kernels::UpdateBlock<N>& update : filters_.updates())
      for (int m = 0; m < M; ++m)
        for (int l = 0; l < M; ++l)
          for (double& lane : update.R[m][l].lane) lane = measurement.R(m, l);
    std::copy(R, R + M * M, told_R_.begin());
    told_ = M;
  }

  std::vector<std::shared_ptr<const Motion>> motions_;
  Blocks modes_;
  Blocks next_;  // what the modes are to become, until all of them have
  PackedFilters<N> filters_;
  double transition_dt_s_ = kNaN;
  bool all_linear_ = true;
  std::vector<kernels::OfFilters> weights_;
  int told_ = 0;  // m of the R that filters_ have been told
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
