// SPDX-License-Identifier: Apache-2.0
// Many filters of one kind that take the same measurements, as a bank of hypotheses does: what is virtual is called
// once for all of them, and motions that several share are asked for F and Q once.
#pragma once

#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "truebearing/core/covariance.hpp"
#include "truebearing/filter/filter_state.hpp"
#include "truebearing/filter/small_matrix.hpp"

namespace truebearing {

class FilterGroup {
 public:
  /// What one filter of the group believes in.
  struct Member {
    std::size_t motion = 0;  ///< place among the group's
    std::size_t sensor = 0;  ///< place among the measurements of an update

    bool operator==(const Member&) const = default;
  };

  virtual ~FilterGroup() = default;

  virtual int states() const = 0;  ///< n
  virtual std::size_t size() const = 0;

  /// Member i begins anew with x (n) and P (n x n, by columns). False where these are not finite, or P no covariance.
  virtual bool begin(std::size_t i, const double* x, const double* P) = 0;
  /// All cross dt_s seconds. False where one failed: then some have crossed and some have not.
  virtual bool predict(double dt_s) = 0;
  /// Each takes its sensor's of `measurements`; gained[i] becomes the log likelihood of member i's innovation, up to
  /// the power of 2 pi that all share, and minus infinity where it failed.
  virtual void update(std::span<const AnyMeasurement* const> measurements, std::span<double> gained) = 0;
  /// x = sum w_i x_i / sum w, P = sum w_i / sum w (P_i + (x_i - x)(x_i - x)'), over the members with a weight. The list
  /// of weights is padded with zeros (padded_to_widest() of core/simd_width.hpp).
  virtual void mix(std::span<const double> weights, double sum, BoundedVector& x, BoundedMatrix& P) const = 0;
  /// x (n) and P (n x n) of member i.
  virtual void estimate(std::size_t i, BoundedVector& x, BoundedMatrix& P) const = 0;
  /// A state under member i's filter and motion, not begun, for those who look back (backward_step.hpp).
  virtual std::unique_ptr<TrackedState> state_of(std::size_t i) const = 0;
  /// Becomes a copy of `other`, which was made by fresh() from this one or from the same.
  virtual void assign(const FilterGroup& other) = 0;
  virtual std::unique_ptr<FilterGroup> fresh() const = 0;

 protected:
  FilterGroup() = default;
  FilterGroup(const FilterGroup&) = default;
  FilterGroup& operator=(const FilterGroup&) = delete;
};

/// The motion that a group's members share, as far as it was computed.
template <int N>
struct GivenTransition {
  using Scalar = double;
  static constexpr int kStates = N;
  using Matrix = Eigen::Matrix<double, N, N>;

  Matrix F_dt;
  Matrix Q_dt;

  const Matrix& F(double) const { return F_dt; }
  const Matrix& Q(double) const { return Q_dt; }
};

template <typename Filter>
class FilterGroupOf final : public FilterGroup {
  static constexpr int N = Filter::kStates;
  using Motion = SizedMotion<N>;
  using State = Eigen::Matrix<double, N, 1>;
  using Covariance = Eigen::Matrix<double, N, N>;

 public:
  FilterGroupOf(std::vector<std::shared_ptr<const Motion>> motions, std::vector<Member> members)
      : motions_(std::move(motions)), members_(std::move(members)), transitions_(motions_.size()) {
    filters_.assign(members_.size(), Filter(State::Zero(), Covariance::Identity()));
  }

  int states() const override { return N; }
  std::size_t size() const override { return filters_.size(); }

  bool begin(std::size_t i, const double* x, const double* P) override {
    filters_[i] = Filter(matrix_at<N, 1>(x), matrix_at<N, N>(P));
    return is_finite(filters_[i].x()) && is_finite(filters_[i].P());
  }

  bool predict(double dt_s) override {
    for (std::size_t m = 0; m < motions_.size(); ++m)
      if (motions_[m]->is_linear()) transitions_[m] = {motions_[m]->F(State::Zero(), dt_s), motions_[m]->Q(dt_s)};
    bool valid = true;
    for (std::size_t i = 0; i < filters_.size(); ++i) {
      const std::size_t m = members_[i].motion;
      if (motions_[m]->is_linear())
        valid &= filters_[i].predict(transitions_[m], dt_s) != StepStatus::failed;
      else
        valid &= filters_[i].predict(*motions_[m], dt_s) != StepStatus::failed;
    }
    return valid;
  }

  void update(std::span<const AnyMeasurement* const> measurements, std::span<double> gained) override {
    for (std::size_t i = 0; i < filters_.size(); ++i)
      gained[i] =
          with_length(*measurements[members_[i].sensor], [&](const auto& sized) { return take(filters_[i], sized); });
  }

  void mix(std::span<const double> weights, double sum, BoundedVector& x, BoundedMatrix& P) const override {
    State mean;
    fill(mean, 0.0);
    for (std::size_t i = 0; i < filters_.size(); ++i)
      for (int k = 0; k < N; ++k) mean(k) += weights[i] * filters_[i].x()(k);
    for (int k = 0; k < N; ++k) mean(k) /= sum;
    Covariance spread;
    fill(spread, 0.0);
    for (std::size_t i = 0; i < filters_.size(); ++i) {
      if (weights[i] == 0.0) continue;  // it may be so far off that its spread is not finite
      const double weight = weights[i] / sum;
      const State d = minus(filters_[i].x(), mean);
      for (int col = 0; col < N; ++col)
        for (int row = 0; row < N; ++row) spread(row, col) += weight * (filters_[i].P()(row, col) + d(row) * d(col));
    }
    x = mean;
    P = spread;
  }

  void estimate(std::size_t i, BoundedVector& x, BoundedMatrix& P) const override {
    x = filters_[i].x();
    P = filters_[i].P();
  }
  std::unique_ptr<TrackedState> state_of(std::size_t i) const override {
    return std::make_unique<FilterState<Filter>>(motions_[members_[i].motion]);
  }

  void assign(const FilterGroup& other) override { filters_ = static_cast<const FilterGroupOf&>(other).filters_; }
  std::unique_ptr<FilterGroup> fresh() const override { return std::make_unique<FilterGroupOf>(motions_, members_); }

 private:
  template <int M>
  static double take(Filter& filter, const SizedMeasurement<M>& measurement) {
    const Update<N, M> update = update_by(filter, measurement);
    const double gained = -0.5 * (update.nis + log_determinant(update.S));
    return update.status == StepStatus::ok && std::isfinite(gained) ? gained : -std::numeric_limits<double>::infinity();
  }

  std::vector<std::shared_ptr<const Motion>> motions_;
  std::vector<Member> members_;
  std::vector<GivenTransition<N>> transitions_;
  std::vector<Filter> filters_;
};

}  // namespace truebearing
