// SPDX-License-Identifier: Apache-2.0
// PackedFilters: a step of Kalman filters that stand side by side (filter_block.hpp). What a motion or a measurement has
// of its own, F and Q, f of a nonlinear motion, h and H, is asked for filter by filter and put into the filter's lane;
// the arithmetic is done on all of them together (packed_filters_kernel.hpp). Estimates stand with the owner.
// Filter i stands in lane i % kBlock of block i / kBlock. One may stand in several lanes of a block, [first, end).
#pragma once

#include <concepts>
#include <cstddef>
#include <vector>

#include "truebearing/filter/any_measurement.hpp"
#include "truebearing/filter/factorization.hpp"
#include "truebearing/filter/packed_filters_kernel.hpp"
#include "truebearing/filter/small_matrix.hpp"
#include "truebearing/motion/any_motion.hpp"

namespace truebearing {

template <int N>
class PackedFilters {
  using Matrix = typename SizedMotion<N>::Matrix;
  using State = typename SizedMotion<N>::State;

 public:
  using Blocks = std::vector<kernels::FilterBlock<N>>;

  explicit PackedFilters(std::size_t blocks) { resize(blocks); }
  void resize(std::size_t blocks) {
    transitions_.resize(blocks);
    updates_.resize(blocks);
    good_.resize(blocks);
    moved_.reserve(blocks * kernels::kBlock);
  }

  /// Comes before the transitions of a step. What is not found anew stands, but f(x) of a nonlinear motion.
  void begin_transitions() { moved_.clear(); }
  /// That of a filter in `from`, under `motion` over dt_s.
  void find_transition(const SizedMotion<N>& motion, double dt_s, int first, int end, const Blocks& from) {
    State x;
    fill(x, 0.0);
    if (!motion.is_linear()) {
      x = kernels::block_of(from, first).x_of(kernels::lane_of(first));
      moved_.push_back({first, end, motion.f(x, dt_s)});
    }
    const Matrix F = motion.F(x, dt_s), Q = motion.Q(dt_s);
    for (int i = first; i < end; ++i) set_transition(i, F, Q);
  }
  void set_transition(std::integral auto i, const Matrix& F, const Matrix& Q) {
    kernels::block_of(transitions_, i).set(kernels::lane_of(i), F, Q);
  }
  /// The first `count` filters of `from`, to `moved`, which may be the same.
  void predict(int count, const Blocks& from, Blocks& moved) {
    kernels::predict_filters<N>(transitions_.data(), count, from.data(), moved.data(), good_.data());
    for (const Moved& of : moved_)
      for (int i = of.first; i < of.end; ++i) {
        if (!is_finite(of.x)) kernels::block_of(good_, i).set(kernels::lane_of(i), false);
        kernels::set_lane(of.x, kernels::lane_of(i), kernels::block_of(moved, i).x);
      }
  }

  /// nu and H of a measurement that is no position, where a filter in `from` is.
  template <int M>
  void look(const SizedMeasurement<M>& measurement, int first, int end, const Blocks& from) {
    const State x = kernels::block_of(from, first).x_of(kernels::lane_of(first));
    const MeasurementOn<N, M> model{measurement};
    const Eigen::Matrix<double, M, 1> nu = model.residual(measurement.z, model.h(x));
    const Eigen::Matrix<double, M, N> H = model.H(x);
    for (int i = first; i < end; ++i) {
      kernels::UpdateBlock<N>& update = kernels::block_of(updates_, i);
      kernels::set_lane(nu, kernels::lane_of(i), update.nu);
      kernels::set_lane(H, kernels::lane_of(i), update.H);
    }
  }
  /// The first `count` filters of `from`, to `updated`, which may be the same, by what updates() were told: z of a
  /// position, or what look() tells, and R.
  template <int M>
  void update(bool of_position, int count, const Blocks& from, Blocks& updated) {
    const auto kernel = of_position ? kernels::update_filters<N, M, true> : kernels::update_filters<N, M, false>;
    kernel(count, from.data(), updates_.data(), updated.data(), good_.data());
  }
  std::vector<kernels::UpdateBlock<N>>& updates() { return updates_; }
  const std::vector<kernels::UpdateBlock<N>>& updates() const { return updates_; }

  // Of what was predicted or updated, whichever came last.
  /// Those of which it shows at once that x is finite and P a covariance.
  const std::vector<kernels::FilterMask>& good() const { return good_; }
  /// Whether that is so of a filter in `to`, with a second look where it does not show.
  bool is_valid(std::integral auto i, const Blocks& to) const {
    const int lane = kernels::lane_of(i);
    return kernels::block_of(good_, i)[lane] || is_valid_after_all(kernels::block_of(to, i), lane);
  }

 private:
  struct Moved {
    int first, end;
    State x;  // f(x)
  };

  // Out of the way of what is asked of every filter in every step.
  [[gnu::noinline]] static bool is_valid_after_all(const kernels::FilterBlock<N>& block, int lane) {
    return is_finite(block.x_of(lane)) && is_positive_semidefinite<N, double>(block.P_of(lane));
  }

  std::vector<kernels::TransitionBlock<N>> transitions_;
  std::vector<Moved> moved_;  // under nonlinear motions
  std::vector<kernels::UpdateBlock<N>> updates_;
  std::vector<kernels::FilterMask> good_;
};

}  // namespace truebearing
