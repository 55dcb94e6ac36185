// SPDX-License-Identifier: Apache-2.0
#include "truebearing/measurement/posterior_information.hpp"

#include <Eigen/LU>

#include "truebearing/core/linear_algebra.hpp"

namespace truebearing {

template <int States>
void PosteriorInformation<States>::add_prior(const Matrix& P) {
  J_ += inverse_of_positive<States>(P);
}

template <int States>
void PosteriorInformation<States>::predict(const Matrix& F, const Matrix& Q) {
  const Eigen::PartialPivLU<Matrix> transposed(F.transpose());
  const Matrix half = transposed.solve(J_);                         // F^-T J
  const Matrix M = transposed.solve(half.transpose()).transpose();  // (F^-T J) F^-1
  J_ = Eigen::PartialPivLU<Matrix>(identity() + M * Q).solve(M);
  J_ = (0.5 * (J_ + J_.transpose())).eval();
}

template <int States>
std::optional<typename PosteriorInformation<States>::Matrix> PosteriorInformation<States>::covariance() const {
  constexpr double kRounding = 1e-13;
  if (!((J_.diagonal().array() > 0.0).all())) return std::nullopt;
  const State scale = J_.diagonal().array().rsqrt();
  const Matrix scaled = scale.asDiagonal() * J_ * scale.asDiagonal();
  const State modes = symmetric_modes<States>(scaled).values;
  if (modes(0) < kRounding * modes(J_.rows() - 1)) return std::nullopt;
  const Matrix P = inverse_of_positive<States>(scaled);
  return Matrix(scale.asDiagonal() * P * scale.asDiagonal());
}

// Member by member: some compilers would instantiate what the class has for other sizes only.
template void PosteriorInformation<2>::add_prior(const Matrix&);
template void PosteriorInformation<2>::predict(const Matrix&, const Matrix&);
template std::optional<Eigen::Matrix2d> PosteriorInformation<2>::covariance() const;
template void PosteriorInformation<4>::add_prior(const Matrix&);
template void PosteriorInformation<4>::predict(const Matrix&, const Matrix&);
template std::optional<Eigen::Matrix4d> PosteriorInformation<4>::covariance() const;
template void PosteriorInformation<Eigen::Dynamic>::add_prior(const Matrix&);
template void PosteriorInformation<Eigen::Dynamic>::predict(const Matrix&, const Matrix&);
template std::optional<Eigen::MatrixXd> PosteriorInformation<Eigen::Dynamic>::covariance() const;

}  // namespace truebearing
