// SPDX-License-Identifier: Apache-2.0
#include "truebearing/filter/shared_covariance_group.hpp"

#include <algorithm>
#include <type_traits>
#include <utility>

#include "truebearing/core/constants.hpp"
#include "truebearing/core/simd_width.hpp"
#include "truebearing/core/with_count.hpp"
#include "truebearing/filter/factorization.hpp"
#include "truebearing/filter/kalman.hpp"
#include "truebearing/filter/packed_filters.hpp"
#include "truebearing/filter/shared_covariance_kernel.hpp"

namespace truebearing {
namespace {

template <int N, int M>
class SharedCovarianceGroup final : public FilterGroup {
  using Motion = SizedMotion<N>;
  using State = Eigen::Matrix<double, N, 1>;
  using Covariance = Eigen::Matrix<double, N, N>;
  using Motions = std::vector<std::shared_ptr<const Motion>>;
  using Blocks = typename PackedFilters<N>::Blocks;

 public:
  SharedCovarianceGroup(Motions motions, std::vector<Member> members)
      : motions_(std::move(motions)),
        members_(std::move(members)),
        stride_(static_cast<std::size_t>(padded_to_widest(static_cast<int>(members_.size())))),
        x_(N * stride_),
        transitions_(motions_.size()),
        filters_(0) {
    families_.reserve(members_.size());
    for (std::size_t i = 0; i < members_.size(); ++i) {
      if (i == 0 || members_[i] != members_[i - 1]) families_.push_back({i, i, Covariance::Identity()});
      ++families_.back().end;
    }
  }

  int states() const override { return N; }
  std::size_t size() const override { return members_.size(); }

  bool begin(std::size_t i, const double* x, const double* P) override {
    unpack();
    has_transitions_ = false;
    const State own = matrix_at<N, 1>(x);
    const Covariance P0 = KalmanFilter<N>(State::Zero(), matrix_at<N, N>(P)).P();
    for (int k = 0; k < N; ++k) at(k, i) = own[k];
    join_before(set_apart(i, P0));
    return is_finite(own) && is_finite(P0);
  }

  bool predict(double dt_s) override {
    if (dt_s != transition_dt_s_) {
      for (std::size_t m = 0; m < motions_.size(); ++m)
        transitions_[m] = {motions_[m]->F(State::Zero(), dt_s), motions_[m]->Q(dt_s)};
      has_transitions_ = false;
      transition_dt_s_ = dt_s;
    }
    pack();
    if (!has_transitions_) pack_transitions();
    filters_.predict(count(), packed_, next_);
    bool valid = true;
    for (std::size_t f = 0; f < families_.size(); ++f) {
      const Family& family = families_[f];
      if (!filters_.is_valid(f, next_)) {  // P stays as it was
        put(P_of(f), f, next_);
        valid = false;
      }
      kernels::move_means<N>(transitions_[members_[family.first].motion].F_dt.data(), x_.data() + family.first,
                             family.size(), stride_);
    }
    packed_.swap(next_);
    return valid && kernels::all_finite(x_.data(), x_.size());
  }

  void update(std::span<const AnyMeasurement* const> measurements, std::span<double> gained) override {
    pack();
    // Of filters at the origin, which measure that: whether P, S and K are good for all of a family shows there.
    for (std::size_t f = 0; f < families_.size(); ++f) {
      const SizedMeasurement<M>* position = position_of(families_[f], measurements);
      if (!position) continue;
      kernels::UpdateBlock<N>& update = kernels::block_of(filters_.updates(), f);
      kernels::set_lane(Eigen::Matrix<double, M, 1>::Zero(), kernels::lane_of(f), update.nu);
      kernels::set_lane(position->R, kernels::lane_of(f), update.R);
    }
    filters_.template update<M>(true, count(), packed_, next_);
    for (std::size_t f = 0; f < families_.size(); ++f) {
      const Family& family = families_[f];
      double* of_family = gained.data() + family.first;
      std::fill_n(of_family, family.size(), -kInfinity);
      const SizedMeasurement<M>* position = position_of(family, measurements);
      const kernels::UpdateBlock<N>& update = kernels::block_of(filters_.updates(), f);
      const int lane = kernels::lane_of(f);
      if (!position || !is_positive_semidefinite<M, double>(position->R) || !update.has_gain[lane] ||
          !filters_.is_valid(f, next_)) {
        put(P_of(f), f, next_);
        continue;
      }
      Eigen::Matrix<double, N, M> K;
      Eigen::Matrix<double, M, M> S;
      kernels::read_lane(update.K, lane, K);
      kernels::read_lane(update.S, lane, S);
      const Ldlt<M, double> factors(S, Eigen::Matrix<double, M, 1>::Zero());
      // Of an innovation of zero the log likelihood is the determinant's.
      kernels::take_position<N, M>(position->z.data(), K.data(), factors.L.data(), factors.inverse_D.data(),
                                   -2.0 * update.log_likelihood[lane] - M * kernels::kLogTwoPi,
                                   x_.data() + family.first, family.size(), stride_, of_family);
    }
    packed_.swap(next_);
  }

  void mix(std::span<const double> weights, double sum, BoundedVector& x, BoundedMatrix& P) const override {
    x.resize(N);
    P.resize(N, N);
    kernels::mix_means<N>(weights.data(), sum, x_.data(), stride_, x.data(), P.data());
    for (std::size_t f = 0; f < families_.size(); ++f) {
      const double weight = kernels::sum_of(weights.data() + families_[f].first, families_[f].size()) / sum;
      if (weight == 0.0) continue;
      const Covariance of_family = P_of(f);
      for (int col = 0; col < N; ++col)
        for (int row = 0; row < N; ++row) P(row, col) += weight * of_family(row, col);
    }
  }

  void estimate(std::size_t i, BoundedVector& x, BoundedMatrix& P) const override {
    x.resize(N);
    for (int k = 0; k < N; ++k) x[k] = x_[static_cast<std::size_t>(k) * stride_ + i];
    P = P_of(family_of(i));
  }
  std::unique_ptr<TrackedState> state_of(std::size_t i) const override {
    return std::make_unique<FilterState<KalmanFilter<N>>>(motions_[members_[i].motion]);
  }

  void assign(const FilterGroup& other) override {
    const auto& same = static_cast<const SharedCovarianceGroup&>(other);
    const auto is_one = [](const Family& a, const Family& b) { return a.first == b.first && a.end == b.end; };
    has_transitions_ &=
        std::equal(families_.begin(), families_.end(), same.families_.begin(), same.families_.end(), is_one);
    x_ = same.x_;
    families_ = same.families_;
    is_packed_ = same.is_packed_;
    if (!is_packed_) return;
    packed_ = same.packed_;
    resize_packed();
  }
  std::unique_ptr<FilterGroup> fresh() const override {
    return std::make_unique<SharedCovarianceGroup>(motions_, members_);
  }

 private:
  /// Members [first, end), and the P of each.
  struct Family {
    std::size_t first, end;
    Covariance P;  // while it is not packed

    std::size_t size() const { return end - first; }
  };

  double& at(int k, std::size_t i) { return x_[static_cast<std::size_t>(k) * stride_ + i]; }

  int count() const { return static_cast<int>(families_.size()); }

  void resize_packed() {
    const auto blocks = static_cast<std::size_t>(kernels::blocks_of(count()));
    if (next_.size() == blocks && packed_.size() == blocks) return;
    packed_.resize(blocks);
    next_.resize(blocks);
    filters_.resize(blocks);
    has_transitions_ = false;
  }

  void pack() {
    if (is_packed_) return;
    resize_packed();
    for (std::size_t f = 0; f < families_.size(); ++f) put(families_[f].P, f, packed_);
    is_packed_ = true;
  }
  void unpack() {
    for (std::size_t f = 0; is_packed_ && f < families_.size(); ++f) families_[f].P = P_of(f);
    is_packed_ = false;
  }
  void pack_transitions() {
    for (std::size_t f = 0; f < families_.size(); ++f) {
      const GivenTransition<N>& of_motion = transitions_[members_[families_[f].first].motion];
      filters_.set_transition(f, of_motion.F_dt, of_motion.Q_dt);
    }
    has_transitions_ = true;
  }

  static void put(const Covariance& P, std::size_t family, Blocks& blocks) {
    kernels::block_of(blocks, family).set(kernels::lane_of(family), State::Zero(), P);
  }
  Covariance P_of(std::size_t family) const {
    return is_packed_ ? kernels::block_of(packed_, family).P_of(kernels::lane_of(family)) : families_[family].P;
  }

  // What a family measures; nothing where it is no position.
  const SizedMeasurement<M>* position_of(const Family& family,
                                         std::span<const AnyMeasurement* const> measurements) const {
    const AnyMeasurement& taken = *measurements[members_[family.first].sensor];
    return taken.is_position() && taken.size() == M ? static_cast<const SizedMeasurement<M>*>(&taken) : nullptr;
  }

  std::size_t family_of(std::size_t i) const {
    const auto behind = std::upper_bound(families_.begin(), families_.end(), i,
                                         [](std::size_t j, const Family& f) { return j < f.first; });
    return static_cast<std::size_t>(behind - families_.begin()) - 1;
  }

  // Member i leaves its family for one of its own, whose place it gives.
  std::size_t set_apart(std::size_t i, const Covariance& P) {
    auto own = families_.begin() + static_cast<std::ptrdiff_t>(family_of(i));
    const Family whole = *own;
    *own = {i, i + 1, P};
    if (i + 1 < whole.end) own = families_.insert(own + 1, {i + 1, whole.end, whole.P}) - 1;
    if (whole.first < i) own = families_.insert(own, {whole.first, i, whole.P}) + 1;
    return static_cast<std::size_t>(own - families_.begin());
  }

  // A family joins the one before it where they are of one kind.
  void join_before(std::size_t place) {
    if (place == 0) return;
    const Family& own = families_[place];
    Family& before = families_[place - 1];
    if (members_[before.first] != members_[own.first] || before.P != own.P) return;
    before.end = own.end;
    families_.erase(families_.begin() + static_cast<std::ptrdiff_t>(place));
  }

  Motions motions_;
  std::vector<Member> members_;
  std::vector<Family> families_;
  std::size_t stride_;
  std::vector<double> x_;                        // (n x stride) by rows
  std::vector<GivenTransition<N>> transitions_;  // of the motions
  double transition_dt_s_ = kNaN;
  bool is_packed_ = false;  // the families' P stand in packed_
  // The families' filters, each in a lane, at the origin: F, Q, S, K and P are all that is of interest.
  Blocks packed_, next_;
  PackedFilters<N> filters_;
  bool has_transitions_ = false;  // those of these families over that time
};

}  // namespace

std::unique_ptr<FilterGroup> make_shared_covariance_group(const std::vector<std::shared_ptr<const AnyMotion>>& motions,
                                                          const std::vector<FilterGroup::Member>& members, int m) {
  std::unique_ptr<FilterGroup> group;
  with_count(motions.front()->states(), [&]<int N>(std::integral_constant<int, N>) {
    constexpr int M = N <= 3 ? 1 : 2;
    if constexpr (N >= 2 && detail::kHasPositionForm<N, M>) {
      std::vector<std::shared_ptr<const SizedMotion<N>>> sized;
      for (const auto& motion : motions) {
        sized.push_back(std::static_pointer_cast<const SizedMotion<N>>(motion));
        if (!sized.back()->is_linear() || m != M) return;
      }
      group = std::make_unique<SharedCovarianceGroup<N, M>>(std::move(sized), members);
    }
  });
  return group;
}

}  // namespace truebearing
