// TrackedState, the run-time seam between trackers and filters: the estimate of one target under one filter and one
// motion, or under several. Trackers (tracker/) decide what to do with a measurement; what fills the seam does the
// arithmetic. Sizes are known at run time and bounded; nothing allocates after construction.
#pragma once

#include <Eigen/Core>
#include <memory>

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

class TrackedState {
 public:
  using Vector = Eigen::Map<const BoundedVector>;
  using Matrix = Eigen::Map<const BoundedMatrix>;

  virtual ~TrackedState() = default;

  int size() const { return size_; }               ///< n
  Vector x() const { return {x_, size_}; }         ///< (n)
  Matrix P() const { return {P_, size_, size_}; }  ///< (n x n)
  const double* x_data() const { return x_; }
  const double* P_data() const { return P_; }  ///< by columns

  /// Begins anew with x (n) and P (n x n, by columns).
  virtual void begin(const double* x, const double* P) = 0;
  /// Crosses dt_s seconds. `failed` leaves all as it was.
  virtual StepStatus predict(double dt_s) = 0;
  /// Takes one measurement. `failed` leaves the estimate as it was; nu, S and nis then are what the arithmetic came to.
  virtual StepStatus update(const AnyMeasurement& measurement, StateUpdate& update) = 0;
  /// Becomes a copy of `other`, which was made by fresh() from this one or from the same.
  virtual void assign(const TrackedState& other) = 0;
  /// mu (r) of a multiple-model state, else nullptr.
  virtual const ModeVector* mode_probabilities() const { return nullptr; }
  /// An independent state of the same kind, not begun.
  virtual std::unique_ptr<TrackedState> fresh() const = 0;

 protected:
  explicit TrackedState(int size) : size_(size) {}
  TrackedState(const TrackedState&) = delete;
  TrackedState& operator=(const TrackedState&) = delete;
  /// Where the estimate stands, for as long as the object lives.
  void estimate_at(const double* x, const double* P) {
    x_ = x;
    P_ = P;
  }

 private:
  int size_;
  const double* x_ = nullptr;
  const double* P_ = nullptr;
};

}  // namespace truebearing
