// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/QR>

#include "truebearing/core/linear_algebra.hpp"

namespace truebearing {

HermitianModes hermitian_modes(const Eigen::MatrixXcd& A) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXcd> solver(A);
  return {solver.eigenvalues(), solver.eigenvectors()};
}

void solve_positive_in_place(const Eigen::MatrixXcd& A, std::span<Eigen::MatrixXcd> Bs) {
  const Eigen::LLT<Eigen::MatrixXcd> llt(A);
  for (Eigen::MatrixXcd& B : Bs) llt.solveInPlace(B);
}

Eigen::MatrixXcd least_squares(const Eigen::MatrixXcd& A, const Eigen::MatrixXcd& B) {
  return A.colPivHouseholderQr().solve(B);
}

Eigen::VectorXcd eigenvalues(const Eigen::MatrixXcd& A) {
  return Eigen::ComplexEigenSolver<Eigen::MatrixXcd>(A, false).eigenvalues();
}

}  // namespace truebearing
