// SPDX-License-Identifier: Apache-2.0
// One measurement with the model of its step, whose type is not known when the filter is compiled, only the length m of
// z: what filters behind trackers reach a study's choice through. z and R are plain data; h, H and the residual are
// virtual, except of measured positions, for which the filter knows them.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "truebearing/core/bounded.hpp"
#include "truebearing/filter/product.hpp"
#include "truebearing/filter/small_matrix.hpp"
#include "truebearing/measurement/measurement_model.hpp"

namespace truebearing {

inline constexpr int kMaxMeasurements = 4;  ///< m that filters behind trackers are compiled for

/// A measurement of any length.
class AnyMeasurement {
 public:
  virtual ~AnyMeasurement() = default;

  int size() const { return size_; }  ///< m
  /// z = x_1..m + v: H = [I, 0].
  bool is_position() const { return is_position_; }
  Eigen::Map<const BoundedVector> value() const { return {z_, size_}; }  ///< z (m)

 protected:
  AnyMeasurement(int size, bool is_position, const double* z) : size_(size), is_position_(is_position), z_(z) {}
  AnyMeasurement(const AnyMeasurement&) = delete;
  AnyMeasurement& operator=(const AnyMeasurement&) = delete;

 private:
  int size_;
  bool is_position_;
  const double* z_;
};

/// A measurement of length M. `x` points to a state that begins with the k components of the model's own.
template <int M>
class SizedMeasurement : public AnyMeasurement {
 public:
  static_assert(M >= 1 && M <= kMaxMeasurements);
  static constexpr int kMeasurements = M;
  using Vector = Eigen::Matrix<double, M, 1>;
  using Covariance = Eigen::Matrix<double, M, M>;

  Vector z;
  Covariance R;

  virtual Vector h(const double* x) const = 0;
  /// The first k columns of H or g (m x k), by columns; the others are zero.
  virtual void H(const double* x, double* jacobian) const = 0;
  /// H of a model without a modified gain.
  virtual void modified_gain(const double* x, double* g) const = 0;
  virtual Vector residual(const Vector& a, const Vector& b) const = 0;
  /// residual(h(x_i), z_0) of many states (m x count, by columns), x_i at X + i stride.
  virtual void residuals_of(const double* X, int stride, int count, const Vector& z_0, double* residuals) const = 0;

 protected:
  explicit SizedMeasurement(bool is_position)
      : AnyMeasurement(M, is_position, z.data()), z(Vector::Zero()), R(Covariance::Identity()) {}
};

/// A measurement with a model of a known type. z, R and the model belong together: set() makes them so.
template <MeasurementModel Model>
class ErasedMeasurement final : public SizedMeasurement<Model::kMeasurements> {
  static constexpr int M = Model::kMeasurements;
  using State = Eigen::Matrix<double, Model::kStates, 1>;
  using Jacobian = Eigen::Matrix<double, M, Model::kStates>;

 public:
  using typename SizedMeasurement<M>::Vector;

  /// Of nothing yet: set() comes first.
  explicit ErasedMeasurement(bool is_position) : SizedMeasurement<M>(is_position) {}
  ErasedMeasurement(const Model& model, const Vector& value, bool is_position = false)
      : ErasedMeasurement(is_position) {
    set(model, value);
  }
  void set(const Model& model, const Vector& value) {
    model_ = model;
    this->z = value;
    const typename SizedMeasurement<M>::Covariance variances = model.R();
    // Written out: as a loop it would read by pairs what was written number by number.
    detail::each<M * M, M * M>([&](int i) __attribute__((always_inline)) { this->R.data()[i] = variances.data()[i]; });
  }

  Vector h(const double* x) const override { return model_->h(state(x)); }
  void H(const double* x, double* jacobian) const override {
    Eigen::Map<Jacobian> filled(jacobian);
    filled = model_->H(state(x));
  }
  void modified_gain(const double* x, double* g) const override {
    Eigen::Map<Jacobian> filled(g);
    if constexpr (requires(const Model& m) { m.modified_gain(this->z, state(x)); })
      filled = model_->modified_gain(this->z, state(x));
    else
      filled = model_->H(state(x));
  }
  Vector residual(const Vector& a, const Vector& b) const override { return model_->residual(a, b); }
  void residuals_of(const double* X, int stride, int count, const Vector& z_0, double* residuals) const override {
    if constexpr (requires { model_->residuals_of(X, stride, count, z_0, residuals); })
      model_->residuals_of(X, stride, count, z_0, residuals);
    else
      for (int i = 0; i < count; ++i)
        Eigen::Map<Vector>(residuals + i * M) = model_->residual(model_->h(state(X + i * stride)), z_0);
  }

  const Model& model() const { return *model_; }

 private:
  static State state(const double* x) { return State(Eigen::Map<const State>(x)); }

  std::optional<Model> model_;
};

/// A measurement as a measurement model of a state of N components, for the templates.
template <int N, int M>
struct MeasurementOn {
  using Scalar = double;
  static constexpr int kStates = N;
  static constexpr int kMeasurements = M;
  using State = Eigen::Matrix<double, N, 1>;
  using Vector = Eigen::Matrix<double, M, 1>;
  using Jacobian = Eigen::Matrix<double, M, N>;
  using Covariance = Eigen::Matrix<double, M, M>;

  const SizedMeasurement<M>& measurement;

  Vector h(const State& x) const { return measurement.h(x.data()); }
  Jacobian H(const State& x) const {
    Jacobian jacobian;
    fill(jacobian, 0.0);
    measurement.H(x.data(), jacobian.data());
    return jacobian;
  }
  Jacobian modified_gain(const Vector&, const State& x) const {
    Jacobian g;
    fill(g, 0.0);
    measurement.modified_gain(x.data(), g.data());
    return g;
  }
  const Covariance& R() const { return measurement.R; }
  Vector residual(const Vector& a, const Vector& b) const { return measurement.residual(a, b); }
  void residuals_of(const double* X, int stride, int count, const Vector& z_0, double* residuals) const {
    measurement.residuals_of(X, stride, count, z_0, residuals);
  }
};

/// use(measurement) with its length known.
template <typename Use>
auto with_length(const AnyMeasurement& measurement, const Use& use) {
  static_assert(kMaxMeasurements == 4);
  switch (measurement.size()) {
    case 1:
      return use(static_cast<const SizedMeasurement<1>&>(measurement));
    case 2:
      return use(static_cast<const SizedMeasurement<2>&>(measurement));
    case 3:
      return use(static_cast<const SizedMeasurement<3>&>(measurement));
    default:
      return use(static_cast<const SizedMeasurement<4>&>(measurement));
  }
}

}  // namespace truebearing
