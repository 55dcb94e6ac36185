// SPDX-License-Identifier: Apache-2.0
// FilterPack: the StatePack (state_pack.hpp) of Kalman filters in Joseph's form of N states, extended ones too, and of
// multiple models of them. Mode j of the model in lane i stands in lane i of block j; a filter is a model of one mode,
// which nothing is mixed with.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <memory>
#include <type_traits>
#include <utility>
#include <vector>

#include "truebearing/core/constants.hpp"
#include "truebearing/core/with_count.hpp"
#include "truebearing/filter/interacting_multiple_model.hpp"
#include "truebearing/filter/markov_chain.hpp"
#include "truebearing/filter/multiple_models_kernel.hpp"
#include "truebearing/filter/packed_filters.hpp"
#include "truebearing/filter/state_pack.hpp"

namespace truebearing {

template <int N>
class FilterPack final : public StatePack {
  using Motion = SizedMotion<N>;
  using State = Eigen::Matrix<double, N, 1>;
  using Covariance = Eigen::Matrix<double, N, N>;
  using Blocks = typename PackedFilters<N>::Blocks;

 public:
  using Motions = std::vector<std::shared_ptr<const Motion>>;

  /// The motion of each mode, and the chain between them; of a filter its own, and an empty one.
  FilterPack(Motions motions, MarkovChain chain)
      : motions_(std::move(motions)),
        chain_(std::move(chain)),
        held_(motions_.size()),
        next_(motions_.size()),
        filters_(motions_.size()),
        Pi_(motions_.size() * motions_.size()),
        weights_(Pi_.size()),
        held_mu_(motions_.size()),
        mu_(motions_.size()),
        powers_(motions_.size()) {
    for (const auto& motion : motions_) is_linear_ &= motion->is_linear();
    dt_s_.fill(kNaN);
  }

  int free_lane() const override {
    const int lane = first_lane(without(kAllLanes, inside_));
    return lane < kPackLanes ? lane : -1;
  }

  void enter(int lane, const TrackedState& state) override {
    inside_ |= lane_bit(lane);
    if (!is_multiple()) return hold(0, lane, state);
    const auto of_model = state.modes();
    for (std::size_t j = 0; j < modes(); ++j) {
      hold(j, lane, *of_model[j]);
      held_mu_[j][lane] = (*state.mode_probabilities())[static_cast<Eigen::Index>(j)];
    }
  }

  void drop(int lane) override { inside_ = without(inside_, lane_bit(lane)); }

  void leave(int lane, TrackedState& state) override {
    drop(lane);
    if (!is_multiple()) return state.begin(held_[0].x_of(lane).data(), held_[0].P_of(lane).data());
    auto& model = static_cast<InteractingMultipleModel&>(state);
    ModeVector mu(static_cast<Eigen::Index>(modes()));
    for (std::size_t j = 0; j < modes(); ++j)
      model.begin_mode(static_cast<int>(j), held_[j].x_of(lane).data(), held_[j].P_of(lane).data());
    kernels::read_lane(held_mu_.data(), lane, mu);
    model.believe(mu);
  }

  LaneMask predict(LaneMask lanes, const double* dt_s) override {
    kernels::FilterMask can_enter;
    if (is_multiple()) {
      find_chains(lanes, dt_s);
      kernels::weigh_entries(Pi_.data(), held_mu_.data(), count(), mu_.data(), weights_.data(), can_enter);
      kernels::mix_entries<N>(held_.data(), count(), weights_.data(), next_.data());
    }
    const Blocks& from = is_multiple() ? next_ : held_;
    find_transitions(lanes, dt_s, from);
    filters_.predict(count() * kernels::kBlock, from, next_);
    for_each_lane(lanes, [&](int lane) { dt_s_[static_cast<std::size_t>(lane)] = dt_s[lane]; });
    if (!is_multiple()) return lanes & filters_.good().front().lanes();
    kernels::mix_models<N>(next_.data(), count(), mu_.data(), mixed_);
    for (const kernels::FilterMask& good : filters_.good()) can_enter &= good;
    return lanes & can_enter.lanes();
  }

  LaneMask update(LaneMask lanes, const AnyMeasurement* const* measurements) override {
    if (lanes == 0) return 0;
    LaneMask certain = 0;
    with_length(*measurements[first_lane(lanes)], [&]<int M>(const SizedMeasurement<M>& first) {
      if constexpr (M <= kernels::most_measurements(N)) certain = take<M>(lanes, first.is_position(), measurements);
    });
    return certain;
  }

  void keep(LaneMask lanes) override {
    for_each_lane(without(inside_, lanes), [&](int lane) {
      for (std::size_t j = 0; j < modes(); ++j) {
        next_[j].copy(lane, held_[j]);
        mu_[j][lane] = held_mu_[j][lane];
      }
    });
    held_.swap(next_);
    held_mu_.swap(mu_);
  }

  LaneMask within(LaneMask lanes, int positions, double farthest) const override {
    kernels::FilterMask within;
    kernels::find_within(as_one(), positions, farthest, within);
    return lanes & within.lanes();
  }

  void estimate(int lane, double* x, double* P) const override {
    const kernels::FilterBlock<N>& shown = as_one();
    Eigen::Map<State> shown_x(x);
    Eigen::Map<Covariance> shown_P(P);
    kernels::read_lane(shown.x, lane, shown_x);
    kernels::read_lane(shown.P, lane, shown_P);
  }

  void update_of(int lane, const StateUpdateTarget& update) const override {
    const kernels::UpdateBlock<N>& from = is_multiple() ? combined_ : filters_.updates().front();
    update.nis = from.nis[lane];
    update.nu.resize(measured_);
    update.S.resize(measured_, measured_);
    update.K.resize(N, measured_);
    with_count(measured_, [&]<int M>(std::integral_constant<int, M>) {
      if constexpr (M > 0 && M <= kernels::most_measurements(N)) {
        Eigen::Map<Eigen::Matrix<double, M, 1>> nu(update.nu.data());
        Eigen::Map<Eigen::Matrix<double, M, M>> S(update.S.data());
        Eigen::Map<Eigen::Matrix<double, N, M>> K(update.K.data());
        kernels::read_lane(from.nu, lane, nu);
        kernels::read_lane(from.S, lane, S);
        kernels::read_lane(from.K, lane, K);
      }
    });
  }

  void mode_probabilities(int lane, ModeVector& mu) const override {
    mu.resize(is_multiple() ? count() : 0);
    kernels::read_lane(mu_.data(), lane, mu);
  }

 private:
  std::size_t modes() const { return motions_.size(); }
  int count() const { return static_cast<int>(modes()); }
  bool is_multiple() const { return modes() > 1; }
  // What next_ comes to.
  const kernels::FilterBlock<N>& as_one() const { return is_multiple() ? mixed_ : next_.front(); }

  void hold(std::size_t mode, int lane, const TrackedState& state) {
    held_[mode].set(lane, matrix_at<N, 1>(state.x_data()), matrix_at<N, N>(state.P_data()));
  }

  bool is_over_same_time(int lane, const double* dt_s) const {
    return dt_s[lane] == dt_s_[static_cast<std::size_t>(lane)];
  }

  // Pi of every lane. Those over the same time stand.
  void find_chains(LaneMask lanes, const double* dt_s) {
    for_each_lane(lanes, [&](int lane) {
      if (is_over_same_time(lane, dt_s)) return;
      const ModeMatrix Pi = chain_.over(dt_s[lane]);
      for (int i = 0; i < count(); ++i)
        for (int j = 0; j < count(); ++j) Pi_[static_cast<std::size_t>(i * count() + j)][lane] = Pi(i, j);
    });
  }

  // F and Q of every lane. Those of linear motions over the same time stand.
  void find_transitions(LaneMask lanes, const double* dt_s, const Blocks& from) {
    filters_.begin_transitions();
    for_each_lane(lanes, [&](int lane) {
      const bool is_same = is_over_same_time(lane, dt_s);
      if (is_linear_ && is_same) return;
      for (int filter = lane; const auto& motion : motions_) {
        if (!is_same || !motion->is_linear()) filters_.find_transition(*motion, dt_s[lane], filter, filter + 1, from);
        filter += kernels::kBlock;
      }
    });
  }

  template <int M>
  LaneMask take(LaneMask lanes, bool of_position, const AnyMeasurement* const* measurements) {
    measured_ = M;
    for_each_lane(lanes, [&](int lane) {
      const AnyMeasurement& any = *measurements[lane];
      bool can_take = any.size() == M && any.is_position() == of_position;
      if (can_take) {
        const auto& sized = static_cast<const SizedMeasurement<M>&>(any);
        can_take = is_positive_semidefinite<M, double>(sized.R);
        tell(sized, lane);
      }
      if (!can_take) lanes = without(lanes, lane_bit(lane));
    });
    std::vector<kernels::UpdateBlock<N>>& updates = filters_.updates();
    for (std::size_t j = 1; j < modes(); ++j) updates[j].template tell_as<M>(updates.front(), of_position);
    filters_.template update<M>(of_position, count() * kernels::kBlock, next_, next_);
    if (is_multiple()) combine<M>();
    kernels::FilterMask certain = filters_.good().front();
    for (const kernels::FilterMask& good : filters_.good()) certain &= good;
    for (const kernels::UpdateBlock<N>& update : updates) certain &= update.has_gain;
    return lanes & certain.lanes();
  }

  // What is every mode's is told to the first.
  template <int M>
  void tell(const SizedMeasurement<M>& measurement, int lane) {
    kernels::UpdateBlock<N>& first = filters_.updates().front();
    kernels::set_lane(measurement.R, lane, first.R);
    if (measurement.is_position()) return kernels::set_lane(measurement.z, lane, first.nu);
    for (int filter = lane; filter < count() * kernels::kBlock; filter += kernels::kBlock)
      filters_.look(measurement, filter, filter + 1, next_);
  }

  // Equations (11.6.6-13) to (-17), as InteractingMultipleModel::update() has them.
  template <int M>
  void combine() {
    const kernels::UpdateBlock<N>* updates = filters_.updates().data();
    kernels::combine_innovations<N, M>(updates, count(), mu_.data(), combined_);
    kernels::find_exponents<N>(updates, count(), powers_.data());
    for (kernels::OfFilters& powers : powers_)
      for (double& power : powers.lane) power = std::exp(power);
    kernels::weigh_modes(mu_.data(), powers_.data(), count(), mu_.data());
    kernels::combine_gains<N, M>(updates, count(), mu_.data(), combined_);
    kernels::mix_models<N>(next_.data(), count(), mu_.data(), mixed_);
  }

  Motions motions_;  // of the modes
  MarkovChain chain_;
  bool is_linear_ = true;
  LaneMask inside_ = 0;
  Blocks held_, next_;                   // [mode]
  std::array<double, kPackLanes> dt_s_;  // of the last prediction
  PackedFilters<N> filters_;
  std::vector<kernels::OfFilters> Pi_, weights_;  // [i r + j]
  std::vector<kernels::OfFilters> held_mu_, mu_;  // of next_, c where it is predicted
  std::vector<kernels::OfFilters> powers_;
  kernels::FilterBlock<N> mixed_{};  // next_ as one estimate, where there are several modes
  kernels::UpdateBlock<N> combined_{};
  int measured_ = 1;  // m of the last update
};

}  // namespace truebearing
