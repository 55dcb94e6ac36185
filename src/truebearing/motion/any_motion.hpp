// SPDX-License-Identifier: Apache-2.0
// A motion model whose type is not known when the filter is compiled, only the length of its state: what filters
// behind trackers reach a study's choice through. One virtual call carries a whole estimate across.
#pragma once

#include <Eigen/Core>
#include <limits>
#include <string_view>

#include "truebearing/core/status.hpp"

namespace truebearing {

/// A motion model of any length.
class AnyMotion {
 public:
  virtual ~AnyMotion() = default;

  int states() const { return states_; }  ///< n
  /// f(x, dt) = F(dt) x: F does not look at x.
  bool is_linear() const { return is_linear_; }
  /// What stands behind the positions and velocities (and the frequency), or nothing: "accelerations", "turn rate".
  /// Models of which one has what the other lacks may be mixed; of two that differ in it, no state is the beginning of
  /// the other.
  std::string_view rest() const { return rest_; }

 protected:
  AnyMotion(int states, bool is_linear, std::string_view rest) : states_(states), is_linear_(is_linear), rest_(rest) {}
  AnyMotion(const AnyMotion&) = default;
  AnyMotion& operator=(const AnyMotion&) = default;

 private:
  int states_;
  bool is_linear_;
  std::string_view rest_;
};

/// What a motion model gave for one dt, kept by those who cross the same dt again and again.
template <int N>
struct Transition {
  double dt_s = std::numeric_limits<double>::quiet_NaN();  ///< NaN: nothing yet
  Eigen::Matrix<double, N, N> F;                           ///< of a linear model alone
  Eigen::Matrix<double, N, N> Q;
};

/// A motion model of N states (motion_model.hpp).
template <int N>
class SizedMotion : public AnyMotion {
 public:
  static constexpr int kStates = N;
  using Scalar = double;
  using State = Eigen::Matrix<double, N, 1>;
  using Matrix = Eigen::Matrix<double, N, N>;

  virtual State f(const State& x, double dt_s) const = 0;
  virtual Matrix F(const State& x, double dt_s) const = 0;  ///< of a linear model whatever x is
  virtual Matrix Q(double dt_s) const = 0;

  /// x = f(x, dt), P = F P F' + Q. `failed`, where x is then not finite or P no covariance, leaves both as they were.
  /// made: by this motion, or nothing yet; becomes that of dt.
  virtual StepStatus carry(double dt_s, State& x, Matrix& P, Transition<N>& made) const = 0;

 protected:
  SizedMotion(bool is_linear, std::string_view rest) : AnyMotion(N, is_linear, rest) {}
};

}  // namespace truebearing
