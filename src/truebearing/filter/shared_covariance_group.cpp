// SPDX-License-Identifier: Apache-2.0
#include "truebearing/filter/shared_covariance_group.hpp"

#include <algorithm>
#include <type_traits>
#include <utility>

#include "truebearing/core/constants.hpp"
#include "truebearing/core/simd_lanes.hpp"
#include "truebearing/core/with_count.hpp"
#include "truebearing/filter/factorization.hpp"
#include "truebearing/filter/kalman.hpp"
#include "truebearing/filter/shared_covariance_kernel.hpp"

namespace truebearing {
namespace {

template <int N, int M>
class SharedCovarianceGroup final : public FilterGroup {
  using Motion = SizedMotion<N>;
  using State = Eigen::Matrix<double, N, 1>;
  using Covariance = Eigen::Matrix<double, N, N>;
  using Motions = std::vector<std::shared_ptr<const Motion>>;

 public:
  SharedCovarianceGroup(Motions motions, std::vector<Member> members)
      : motions_(std::move(motions)),
        members_(std::move(members)),
        stride_(static_cast<std::size_t>(padded_to_lanes(static_cast<int>(members_.size())))),
        x_(N * stride_),
        transitions_(motions_.size()) {
    families_.reserve(members_.size());
    for (std::size_t i = 0; i < members_.size(); ++i) {
      if (i == 0 || members_[i] != members_[i - 1])
        families_.push_back({i, i, KalmanFilter<N>(State::Zero(), Covariance::Identity())});
      ++families_.back().end;
    }
  }

  int states() const override { return N; }
  std::size_t size() const override { return members_.size(); }

  bool begin(std::size_t i, const double* x, const double* P) override {
    const State own = matrix_at<N, 1>(x);
    const KalmanFilter<N> filter(State::Zero(), matrix_at<N, N>(P));
    for (int k = 0; k < N; ++k) at(k, i) = own[k];
    join_before(set_apart(i, filter));
    return is_finite(own) && is_finite(filter.P());
  }

  bool predict(double dt_s) override {
    if (dt_s != transition_dt_s_)
      for (std::size_t m = 0; m < motions_.size(); ++m)
        transitions_[m] = {motions_[m]->F(State::Zero(), dt_s), motions_[m]->Q(dt_s)};
    transition_dt_s_ = dt_s;
    bool valid = true;
    for (Family& family : families_) {
      const GivenTransition<N>& transition = transitions_[members_[family.first].motion];
      valid &= family.filter.predict(transition, dt_s) != StepStatus::failed;
      kernels::move_means<N>(transition.F_dt.data(), x_.data() + family.first, family.size(), stride_);
    }
    return valid && kernels::all_finite(x_.data(), x_.size());
  }

  void update(std::span<const AnyMeasurement* const> measurements, std::span<double> gained) override {
    for (Family& family : families_) {
      const AnyMeasurement& taken = *measurements[members_[family.first].sensor];
      double* of_family = gained.data() + family.first;
      std::fill_n(of_family, family.size(), -kInfinity);
      if (!taken.is_position() || taken.size() != M) continue;
      const auto& position = static_cast<const SizedMeasurement<M>&>(taken);
      // Of a filter at the origin, which measures that: its status says whether P, S and K are good for all.
      const Update<N, M> common =
          family.filter.update(detail::MeasuredPosition<N, M>{position.R}, Eigen::Matrix<double, M, 1>::Zero().eval());
      if (common.status != StepStatus::ok) continue;
      const Ldlt<M, double> factors(common.S, Eigen::Matrix<double, M, 1>::Zero());
      kernels::take_position<N, M>(position.z.data(), common.K.data(), factors.L.data(), factors.inverse_D.data(),
                                   log_determinant(common.S), x_.data() + family.first, family.size(), stride_,
                                   of_family);
    }
  }

  void mix(std::span<const double> weights, double sum, BoundedVector& x, BoundedMatrix& P) const override {
    x.resize(N);
    P.resize(N, N);
    kernels::mix_means<N>(weights.data(), sum, x_.data(), stride_, x.data(), P.data());
    for (const Family& family : families_) {
      const double weight = kernels::sum_of(weights.data() + family.first, family.size()) / sum;
      if (weight == 0.0) continue;
      for (int col = 0; col < N; ++col)
        for (int row = 0; row < N; ++row) P(row, col) += weight * family.filter.P()(row, col);
    }
  }

  void estimate(std::size_t i, BoundedVector& x, BoundedMatrix& P) const override {
    x.resize(N);
    for (int k = 0; k < N; ++k) x[k] = x_[static_cast<std::size_t>(k) * stride_ + i];
    P = families_[family_of(i)].filter.P();
  }
  std::unique_ptr<TrackedState> state_of(std::size_t i) const override {
    return std::make_unique<FilterState<KalmanFilter<N>>>(motions_[members_[i].motion]);
  }

  void assign(const FilterGroup& other) override {
    const auto& same = static_cast<const SharedCovarianceGroup&>(other);
    families_ = same.families_;
    x_ = same.x_;
  }
  std::unique_ptr<FilterGroup> fresh() const override {
    return std::make_unique<SharedCovarianceGroup>(motions_, members_);
  }

 private:
  /// Members [first, end), and the P of each.
  struct Family {
    std::size_t first, end;
    KalmanFilter<N> filter;  // at the origin

    std::size_t size() const { return end - first; }
  };

  double& at(int k, std::size_t i) { return x_[static_cast<std::size_t>(k) * stride_ + i]; }

  std::size_t family_of(std::size_t i) const {
    const auto behind = std::upper_bound(families_.begin(), families_.end(), i,
                                         [](std::size_t j, const Family& f) { return j < f.first; });
    return static_cast<std::size_t>(behind - families_.begin()) - 1;
  }

  // Member i leaves its family for one of its own, whose place it gives.
  std::size_t set_apart(std::size_t i, const KalmanFilter<N>& filter) {
    auto own = families_.begin() + static_cast<std::ptrdiff_t>(family_of(i));
    const Family whole = *own;
    *own = {i, i + 1, filter};
    if (i + 1 < whole.end) own = families_.insert(own + 1, {i + 1, whole.end, whole.filter}) - 1;
    if (whole.first < i) own = families_.insert(own, {whole.first, i, whole.filter}) + 1;
    return static_cast<std::size_t>(own - families_.begin());
  }

  // A family joins the one before it where they are of one kind.
  void join_before(std::size_t place) {
    if (place == 0) return;
    const Family& own = families_[place];
    Family& before = families_[place - 1];
    if (members_[before.first] != members_[own.first] || before.filter.P() != own.filter.P()) return;
    before.end = own.end;
    families_.erase(families_.begin() + static_cast<std::ptrdiff_t>(place));
  }

  Motions motions_;
  std::vector<Member> members_;
  std::vector<Family> families_;
  std::size_t stride_;
  std::vector<double> x_;  // (n x stride) by rows
  std::vector<GivenTransition<N>> transitions_;
  double transition_dt_s_ = kNaN;
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
