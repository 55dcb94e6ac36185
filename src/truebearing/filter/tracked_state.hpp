// SPDX-License-Identifier: Apache-2.0
// TrackedState, the run-time seam between trackers and filters: the estimate of one target under one filter and one
// motion, or under several. Trackers (tracker/) decide what to do with a measurement; what fills the seam does the
// arithmetic. Sizes are known at run time and bounded; nothing allocates after construction.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <span>

#include "truebearing/core/bounded.hpp"
#include "truebearing/core/status.hpp"
#include "truebearing/filter/any_measurement.hpp"

namespace truebearing {

/// What one measurement update leaves behind besides the new state; see Update.
struct StateUpdate {
  BoundedVector nu;  ///< (m)
  BoundedMatrix S;   ///< (m x m)
  BoundedMatrix K;   ///< (n x m)
  double nis = 0.0;
};

/// Where an update is to leave that: in a StateUpdate, or in the blocks of a record.
struct StateUpdateTarget {
  BoundedVector& nu;
  BoundedMatrix& S;
  BoundedMatrix& K;
  double& nis;

  StateUpdateTarget(BoundedVector& nu_in, BoundedMatrix& S_in, BoundedMatrix& K_in, double& nis_in)
      : nu(nu_in), S(S_in), K(K_in), nis(nis_in) {}
  StateUpdateTarget(StateUpdate& update) : nu(update.nu), S(update.S), K(update.K), nis(update.nis) {}  // NOLINT
};

class TrackedState {
 public:
  using Vector = Eigen::Map<const BoundedVector>;
  using Matrix = Eigen::Map<const BoundedMatrix>;

  virtual ~TrackedState() = default;

  int size() const { return size_; }                     ///< n
  Vector x() const { return {x_data(), size_}; }         ///< (n)
  Matrix P() const { return {P_data(), size_, size_}; }  ///< (n x n)
  const double* x_data() const { return is_current_ ? x_ : (refresh(), x_); }
  const double* P_data() const { return is_current_ ? P_ : (refresh(), P_); }  ///< by columns

  /// Begins anew with x (n) and P (n x n, by columns).
  virtual void begin(const double* x, const double* P) = 0;
  /// Crosses dt_s seconds. `failed` leaves all as it was.
  virtual StepStatus predict(double dt_s) = 0;
  /// Takes one measurement. `failed` leaves the estimate as it was; nu, S and nis then are what the arithmetic came to.
  virtual StepStatus update(const AnyMeasurement& measurement, const StateUpdateTarget& update) = 0;
  /// Becomes a copy of `other`, which was made by fresh() from this one or from the same.
  virtual void assign(const TrackedState& other) = 0;
  /// mu (r) of a multiple-model state, else nullptr.
  const ModeVector* mode_probabilities() const { return mu_; }
  /// An independent state of the same kind, not begun.
  virtual std::unique_ptr<TrackedState> fresh() const = 0;

  // For those who look back (backward_step.hpp).
  /// Of a single filter Cov(x, x dt_s later) (n x n), the estimate as it stands: P F', or what its points say. Empty of a
  /// multiple model, whose modes are to be asked.
  virtual BoundedMatrix cross_covariance(double) const { return {}; }
  /// The modes of a multiple model (r); none of a single filter.
  virtual std::span<const std::unique_ptr<TrackedState>> modes() const { return {}; }
  /// Pi (r x r) of a multiple model over dt_s.
  virtual ModeMatrix transition(double) const { return ModeMatrix::Ones(1, 1); }

 protected:
  explicit TrackedState(int size) : size_(size) {}
  TrackedState(const TrackedState&) = delete;
  TrackedState& operator=(const TrackedState&) = delete;
  /// Where the estimate stands, for as long as the object lives.
  void estimate_at(const double* x, const double* P) {
    x_ = x;
    P_ = P;
  }
  void mode_probabilities_at(const ModeVector* mu) { mu_ = mu; }
  /// Of a state whose estimate is made when it is asked for: from now on refresh() has to make it.
  void out_of_date() { is_current_ = false; }
  void up_to_date() const { is_current_ = true; }
  virtual void refresh() const {}

 private:
  int size_;
  const double* x_ = nullptr;
  const double* P_ = nullptr;
  const ModeVector* mu_ = nullptr;
  mutable bool is_current_ = true;
};

}  // namespace truebearing
