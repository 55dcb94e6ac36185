// SPDX-License-Identifier: Apache-2.0
#include "truebearing/filter/state_pack.hpp"

#include <array>
#include <cmath>
#include <limits>
#include <type_traits>
#include <utility>
#include <vector>

#include "truebearing/core/constants.hpp"
#include "truebearing/core/with_count.hpp"
#include "truebearing/filter/filter_kinds.hpp"
#include "truebearing/filter/interacting_multiple_model.hpp"
#include "truebearing/filter/multiple_models_kernel.hpp"

namespace truebearing {
namespace {

using kernels::OfFilters;

// Lane i of block j is mode j of the model in lane i. A filter is a model of one mode, which nothing is mixed with.
template <int N>
class FilterPack final : public StatePack {
  using Motion = SizedMotion<N>;
  using State = Eigen::Matrix<double, N, 1>;
  using Matrix = Eigen::Matrix<double, N, N>;

 public:
  using Motions = std::vector<std::shared_ptr<const Motion>>;

  FilterPack(Motions motions, MarkovChain chain)
      : motions_(std::move(motions)),
        chain_(std::move(chain)),
        held_(motions_.size()),
        next_(motions_.size()),
        transitions_(motions_.size()),
        updates_(motions_.size()),
        good_(motions_.size()),
        Pi_(motions_.size() * motions_.size()),
        weights_(Pi_.size()),
        held_mu_(motions_.size()),
        mu_(motions_.size()),
        powers_(motions_.size()) {
    for (const auto& motion : motions_) is_linear_ &= motion->is_linear();
    dt_s_.fill(kNaN);
    nonlinear_.reserve(motions_.size() * kPackLanes);
  }

  int free_lane() const override {
    for (int lane = 0; lane < kPackLanes; ++lane)
      if (!has_lane(inside_, lane)) return lane;
    return -1;
  }

  void enter(int lane, const TrackedState& state) override {
    inside_ |= lane_bit(lane);
    if (!is_multiple()) return set(0, lane, state);
    const auto of_model = state.modes();
    for (int j = 0; j < modes(); ++j) {
      set(j, lane, *of_model[static_cast<std::size_t>(j)]);
      at(held_mu_, j)[lane] = (*state.mode_probabilities())[j];
    }
  }

  void drop(int lane) override { inside_ &= static_cast<LaneMask>(~lane_bit(lane)); }

  void leave(int lane, TrackedState& state) override {
    drop(lane);
    State x;
    Matrix P;
    if (!is_multiple()) {
      read(held_.front(), lane, x.data(), P.data());
      return state.begin(x.data(), P.data());
    }
    auto& model = static_cast<InteractingMultipleModel&>(state);
    ModeVector mu(modes());
    for (int j = 0; j < modes(); ++j) {
      read(at(held_, j), lane, x.data(), P.data());
      model.begin_mode(j, x.data(), P.data());
      mu[j] = at(held_mu_, j)[lane];
    }
    model.believe(mu);
  }

  LaneMask predict(LaneMask lanes, const double* dt_s) override {
    kernels::FilterMask can_enter;
    if (is_multiple()) {
      find_chains(lanes, dt_s);
      kernels::weigh_entries(Pi_.data(), held_mu_.data(), modes(), mu_.data(), weights_.data(), can_enter);
      kernels::mix_entries<N>(held_.data(), modes(), weights_.data(), next_.data());
    }
    const kernels::FilterBlock<N>* from = is_multiple() ? next_.data() : held_.data();
    find_transitions(lanes, dt_s, from);
    kernels::predict_filters<N>(transitions_.data(), modes() * kernels::kBlock, from, next_.data(), good_.data());
    for (const Moved& moved : nonlinear_) {
      if (!is_finite(moved.x)) at(good_, moved.mode).lane[moved.lane] = 0;
      for (int i = 0; i < N; ++i) at(next_, moved.mode).x[i][moved.lane] = moved.x[i];
    }
    for (int lane = 0; lane < kPackLanes; ++lane)
      if (has_lane(lanes, lane)) dt_s_[static_cast<std::size_t>(lane)] = dt_s[lane];
    LaneMask certain = lanes & all_good();
    if (is_multiple()) {
      certain &= mask_of(can_enter);
      kernels::mix_models<N>(next_.data(), modes(), mu_.data(), mixed_);
    }
    return certain;
  }

  LaneMask update(LaneMask lanes, const AnyMeasurement* const* measurements) override {
    if (lanes == 0) return 0;
    int first = 0;
    while (!has_lane(lanes, first)) ++first;
    LaneMask certain = 0;
    with_length(*measurements[first], [&]<int M>(const SizedMeasurement<M>& sized) {
      if constexpr (M <= kernels::most_measurements(N)) certain = take<M>(lanes, sized.is_position(), measurements);
    });
    return certain;
  }

  void keep(LaneMask lanes) override {
    const auto others = static_cast<LaneMask>(inside_ & ~lanes);
    for (int lane = 0; lane < kPackLanes; ++lane) {
      if (!has_lane(others, lane)) continue;
      for (int j = 0; j < modes(); ++j) {
        copy_lane(at(held_, j), lane, at(next_, j));
        at(mu_, j)[lane] = at(held_mu_, j)[lane];
      }
    }
    held_.swap(next_);
    held_mu_.swap(mu_);
  }

  LaneMask within(LaneMask lanes, int positions, double farthest) const override {
    const kernels::FilterBlock<N>& shown = is_multiple() ? mixed_ : next_.front();
    std::array<bool, kPackLanes> is_within;
    is_within.fill(true);
    for (int i = 0; i < N; ++i) {
      const double most = i < positions ? farthest : std::numeric_limits<double>::max();
      const double most_variance = i < positions ? farthest * farthest : most;
      for (int lane = 0; lane < kPackLanes; ++lane)
        is_within[static_cast<std::size_t>(lane)] &=
            (std::abs(shown.x[i][lane]) <= most) & (shown.P[i][i][lane] <= most_variance);
    }
    for (int lane = 0; lane < kPackLanes; ++lane)
      if (!is_within[static_cast<std::size_t>(lane)]) lanes &= static_cast<LaneMask>(~lane_bit(lane));
    return lanes;
  }

  void estimate(int lane, double* x, double* P) const override {
    read(is_multiple() ? mixed_ : next_.front(), lane, x, P);
  }

  void update_of(int lane, const StateUpdateTarget& update) const override {
    const kernels::UpdateBlock<N>& from = is_multiple() ? combined_ : updates_.front();
    const int m = measured_;
    update.nu.resize(m);
    update.S.resize(m, m);
    update.K.resize(N, m);
    for (int l = 0; l < m; ++l) {
      update.nu[l] = from.nu[l][lane];
      for (int k = 0; k < m; ++k) update.S(k, l) = from.S[k][l][lane];
      for (int i = 0; i < N; ++i) update.K(i, l) = from.K[i][l][lane];
    }
    update.nis = from.nis[lane];
  }

  void mode_probabilities(int lane, ModeVector& mu) const override {
    mu.resize(is_multiple() ? modes() : 0);
    for (Eigen::Index j = 0; j < mu.size(); ++j) mu[j] = at(mu_, static_cast<int>(j))[lane];
  }

 private:
  struct Moved {
    int mode, lane;
    State x;
  };

  int modes() const { return static_cast<int>(motions_.size()); }
  bool is_multiple() const { return motions_.size() > 1; }
  template <typename Block>
  static Block& at(std::vector<Block>& blocks, int mode) {
    return blocks[static_cast<std::size_t>(mode)];
  }
  template <typename Block>
  static const Block& at(const std::vector<Block>& blocks, int mode) {
    return blocks[static_cast<std::size_t>(mode)];
  }

  void set(int mode, int lane, const TrackedState& state) {
    const double *x = state.x_data(), *P = state.P_data();
    for (int i = 0; i < N; ++i) {
      at(held_, mode).x[i][lane] = x[i];
      for (int j = 0; j < N; ++j) at(held_, mode).P[i][j][lane] = P[i + j * N];
    }
  }
  static void read(const kernels::FilterBlock<N>& block, int lane, double* x, double* P) {
    for (int i = 0; i < N; ++i) {
      x[i] = block.x[i][lane];
      for (int j = 0; j < N; ++j) P[j + i * N] = block.P[i][j][lane];  // symmetric
    }
  }
  static void copy_lane(const kernels::FilterBlock<N>& from, int lane, kernels::FilterBlock<N>& to) {
    for (int i = 0; i < N; ++i) {
      to.x[i][lane] = from.x[i][lane];
      for (int j = 0; j < N; ++j) to.P[i][j][lane] = from.P[i][j][lane];
    }
  }

  static LaneMask mask_of(const kernels::FilterMask& good) {
    unsigned lanes = 0;
    for (int lane = 0; lane < kPackLanes; ++lane) lanes |= static_cast<unsigned>(good[lane]) << lane;
    return static_cast<LaneMask>(lanes);
  }
  // Where all modes are.
  LaneMask all_good() const {
    LaneMask lanes = 0xff;
    for (const kernels::FilterMask& good : good_) lanes &= mask_of(good);
    return lanes;
  }

  // Pi of every lane. Those over the same time stand.
  void find_chains(LaneMask lanes, const double* dt_s) {
    for (int lane = 0; lane < kPackLanes; ++lane) {
      if (!has_lane(lanes, lane) || dt_s[lane] == dt_s_[static_cast<std::size_t>(lane)]) continue;
      const ModeMatrix Pi = chain_.over(dt_s[lane]);
      for (int i = 0; i < modes(); ++i)
        for (int j = 0; j < modes(); ++j) at(Pi_, i * modes() + j)[lane] = Pi(i, j);
    }
  }

  // F and Q of every lane. Those of linear motions over the same time stand.
  void find_transitions(LaneMask lanes, const double* dt_s, const kernels::FilterBlock<N>* from) {
    nonlinear_.clear();
    for (int lane = 0; lane < kPackLanes; ++lane) {
      const bool is_same = dt_s[lane] == dt_s_[static_cast<std::size_t>(lane)];
      if (!has_lane(lanes, lane) || (is_linear_ && is_same)) continue;
      for (int j = 0; j < modes(); ++j) {
        const Motion& motion = *at(motions_, j);
        if (motion.is_linear() && is_same) continue;
        State x = State::Zero();
        if (!motion.is_linear()) {
          for (int i = 0; i < N; ++i) x[i] = from[j].x[i][lane];
          nonlinear_.push_back({j, lane, motion.f(x, dt_s[lane])});
        }
        const Matrix F = motion.F(x, dt_s[lane]), Q = motion.Q(dt_s[lane]);
        for (int i = 0; i < N; ++i)
          for (int k = 0; k < N; ++k) {
            at(transitions_, j).F[i][k][lane] = F(i, k);
            at(transitions_, j).Q[i][k][lane] = Q(i, k);
          }
      }
    }
  }

  template <int M>
  LaneMask take(LaneMask lanes, bool of_position, const AnyMeasurement* const* measurements) {
    measured_ = M;
    for (int lane = 0; lane < kPackLanes; ++lane) {
      if (!has_lane(lanes, lane)) continue;
      const AnyMeasurement& any = *measurements[lane];
      bool can_take = any.size() == M && any.is_position() == of_position;
      if (can_take) {
        const auto& sized = static_cast<const SizedMeasurement<M>&>(any);
        can_take = is_positive_semidefinite<M, double>(sized.R);
        for (int j = 0; j < modes(); ++j) tell<M>(sized, j, lane);
      }
      if (!can_take) lanes &= static_cast<LaneMask>(~lane_bit(lane));
    }
    if (of_position)
      kernels::update_filters<N, M, true>(modes() * kernels::kBlock, next_.data(), updates_.data(), next_.data(),
                                          good_.data());
    else
      kernels::update_filters<N, M, false>(modes() * kernels::kBlock, next_.data(), updates_.data(), next_.data(),
                                           good_.data());
    LaneMask certain = lanes & all_good();
    for (const kernels::UpdateBlock<N>& update : updates_) certain &= mask_of(update.has_gain);
    if (is_multiple()) combine<M>();
    return certain;
  }

  template <int M>
  void tell(const SizedMeasurement<M>& measurement, int mode, int lane) {
    kernels::UpdateBlock<N>& update = at(updates_, mode);
    for (int m = 0; m < M; ++m) {
      update.nu[m][lane] = measurement.z[m];
      for (int l = 0; l < M; ++l) update.R[m][l][lane] = measurement.R(m, l);
    }
    if (measurement.is_position()) return;
    State x;
    for (int i = 0; i < N; ++i) x[i] = at(next_, mode).x[i][lane];
    const MeasurementOn<N, M> model{measurement};
    const Eigen::Matrix<double, M, 1> nu = model.residual(measurement.z, model.h(x));
    const Eigen::Matrix<double, M, N> H = model.H(x);
    for (int m = 0; m < M; ++m) {
      update.nu[m][lane] = nu[m];
      for (int i = 0; i < N; ++i) update.H[m][i][lane] = H(m, i);
    }
  }

  // Equations (11.6.6-13) to (-17), as InteractingMultipleModel::update() has them.
  template <int M>
  void combine() {
    kernels::combine_innovations<N, M>(updates_.data(), modes(), mu_.data(), combined_);
    kernels::find_exponents<N>(updates_.data(), modes(), powers_.data());
    for (OfFilters& powers : powers_)
      for (double& power : powers.lane) power = std::exp(power);
    kernels::weigh_modes(mu_.data(), powers_.data(), modes(), mu_.data());
    kernels::combine_gains<N, M>(updates_.data(), modes(), mu_.data(), combined_);
    kernels::mix_models<N>(next_.data(), modes(), mu_.data(), mixed_);
  }

  Motions motions_;  // of the modes
  MarkovChain chain_;
  bool is_linear_ = true;
  LaneMask inside_ = 0;
  std::vector<kernels::FilterBlock<N>> held_, next_;  // [mode]
  std::array<double, kPackLanes> dt_s_;               // of the last prediction
  std::vector<kernels::TransitionBlock<N>> transitions_;
  std::vector<Moved> nonlinear_;  // f(x) where the motion is
  std::vector<kernels::UpdateBlock<N>> updates_;
  std::vector<kernels::FilterMask> good_;  // of next_
  std::vector<OfFilters> Pi_, weights_;    // [i r + j]
  std::vector<OfFilters> held_mu_, mu_;    // of next_, c where it is predicted
  std::vector<OfFilters> powers_;
  kernels::FilterBlock<N> mixed_{};  // next_ as one estimate, where there are several modes
  kernels::UpdateBlock<N> combined_{};
  int measured_ = 1;  // m of the last update
};

template <int N>
std::unique_ptr<StatePack> filter_pack(const TrackedState& state) {
  typename FilterPack<N>::Motions motions;
  const auto add = [&](const TrackedState& mode) {
    const auto* filter = dynamic_cast<const FilterState<KalmanFilter<N>>*>(&mode);
    if (filter) motions.push_back(filter->motion());
    return filter != nullptr;
  };
  if (const auto* model = dynamic_cast<const InteractingMultipleModel*>(&state)) {
    if (model->modes().size() < 2) return nullptr;
    for (const auto& mode : model->modes())
      if (!add(*mode)) return nullptr;
    return std::make_unique<FilterPack<N>>(std::move(motions), model->chain());
  }
  if (!add(state)) return nullptr;
  return std::make_unique<FilterPack<N>>(std::move(motions), MarkovChain{});
}

// Whether a lane costs less in a pack than by itself.
bool has_long_registers() {
#if defined(__x86_64__) && defined(__GNUC__)
  return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
#else
  return false;
#endif
}

}  // namespace

std::unique_ptr<StatePack> pack_of(const TrackedState& state) {
  std::unique_ptr<StatePack> pack;
  if (!has_long_registers()) return pack;
  with_count(state.size(), [&]<int N>(std::integral_constant<int, N>) {
    if constexpr (N == 2 || N == 4 || N == 6) pack = filter_pack<N>(state);
  });
  return pack;
}

}  // namespace truebearing
