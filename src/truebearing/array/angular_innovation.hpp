// SPDX-License-Identifier: Apache-2.0
// The angular innovation of a target from the signal subspace: by how much the angle has to move from its prediction
// for the steering vector a + b d_theta to lie in the span of W (M x N). Three ways to the same least-squares estimate:
//     RyuInnovation         all unknowns at once: d_theta and the N complex coordinates (Ryu, Lee and Lee 1999)
//     ProjectionInnovation  d_theta alone, with P_perp = I - W (W^H W)^-1 W^H (Ryu, Lee and Lee 2001, equations
//                           (7)-(13))
//     ImplicitInnovation    the same without a matrix of the sensors:
//         d_theta = -[Re(b^H a) - Re(yb^H ya)] / (|b|^2 - |yb|^2),  W^H W = L L^H,  ya = L^-1 W^H a,  yb = L^-1 W^H b
// The printed P_perp has a transpose too many: with it, which conjugates the projector, no run keeps its targets.
// Templates on the scalar, so that operations can be counted. The inverses are the papers' own; products are lazy, as
// Eigen's others multiply every result by 1 as well.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstddef>
#include <utility>

#include "truebearing/array/line_array.hpp"

namespace truebearing {

/// d_theta in radians, and what of |b|^2 lies outside the subspace: the curvature of the misfit, > 0 where d_theta
/// means anything.
template <typename Real>
struct AngularInnovation {
  Real angle_rad;
  Real curvature;
};

namespace detail {

/// A <- A^-1 by elimination with row pivoting, as many operations as 2 n^3.
template <typename Real>
void invert(Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic>& A, Eigen::VectorXi& order) {
  using std::abs;
  using std::swap;
  const Eigen::Index n = A.rows();
  order.resize(n);
  for (Eigen::Index k = 0; k < n; ++k) {
    Eigen::Index pivot = k;
    for (Eigen::Index i = k + 1; i < n; ++i)
      if (abs(A(i, k)) > abs(A(pivot, k))) pivot = i;
    order[k] = static_cast<int>(pivot);
    for (Eigen::Index j = 0; j < n; ++j) swap(A(k, j), A(pivot, j));
    const Real inverse = Real(1) / A(k, k);
    A(k, k) = Real(1);
    for (Eigen::Index j = 0; j < n; ++j) A(k, j) *= inverse;
    for (Eigen::Index i = 0; i < n; ++i) {
      if (i == k) continue;
      const Real factor = A(i, k);
      A(i, k) = Real(0);
      for (Eigen::Index j = 0; j < n; ++j) A(i, j) -= factor * A(k, j);
    }
  }
  for (Eigen::Index k = n - 1; k >= 0; --k)
    for (Eigen::Index i = 0; i < n; ++i) swap(A(i, k), A(i, order[k]));
}

/// Re(x^H y) of columns.
template <typename Real>
Real real_product(const SplitMatrix<Real>& x, Eigen::Index i, const SplitMatrix<Real>& y, Eigen::Index j) {
  return x.re.col(i).dot(y.re.col(j)) + x.im.col(i).dot(y.im.col(j));
}

}  // namespace detail

template <typename Real = double>
class RyuInnovation {
 public:
  void prepare(const SplitMatrix<Real>& W) {
    const Eigen::Index M = W.rows(), N = W.cols();
    A_.setZero(2 * M, 2 * N + 1);
    A_.block(0, 0, M, N) = W.re;
    A_.block(M, 0, M, N) = W.im;
    A_.block(0, N, M, N) = -W.im;
    A_.block(M, N, M, N) = W.re;
    right_.resize(2 * M);
  }
  /// Of column n of a and b, with the W that was prepared.
  AngularInnovation<Real> operator()(const SplitMatrix<Real>& a, const SplitMatrix<Real>& b, Eigen::Index n) {
    const Eigen::Index M = a.rows(), last = A_.cols() - 1;
    A_.col(last).head(M) = -b.re.col(n);
    A_.col(last).tail(M) = -b.im.col(n);
    right_.head(M) = a.re.col(n);
    right_.tail(M) = a.im.col(n);
    normal_.noalias() = A_.transpose().lazyProduct(A_);  // W c - b d_theta = a
    detail::invert(normal_, order_);
    solver_.noalias() = normal_.lazyProduct(A_.transpose());
    solution_.noalias() = solver_.lazyProduct(right_);
    return {solution_[last], Real(1) / normal_(last, last)};
  }

 private:
  using Matrix = typename SplitMatrix<Real>::Matrix;
  Matrix A_, normal_, solver_;
  Eigen::Matrix<Real, Eigen::Dynamic, 1> right_, solution_;
  Eigen::VectorXi order_;
};

template <typename Real = double>
class ProjectionInnovation {
 public:
  void prepare(const SplitMatrix<Real>& W) {
    const Eigen::Index M = W.rows(), N = W.cols();
    // (W^H W)^-1 as that of the real matrix [Re -Im; Im Re].
    gram_.resize(2 * N, 2 * N);
    gram_.topLeftCorner(N, N).noalias() = W.re.transpose().lazyProduct(W.re);
    gram_.topLeftCorner(N, N).noalias() += W.im.transpose().lazyProduct(W.im);
    gram_.bottomLeftCorner(N, N).noalias() = W.re.transpose().lazyProduct(W.im);
    gram_.bottomLeftCorner(N, N).noalias() -= W.im.transpose().lazyProduct(W.re);
    gram_.topRightCorner(N, N) = -gram_.bottomLeftCorner(N, N);
    gram_.bottomRightCorner(N, N) = gram_.topLeftCorner(N, N);
    detail::invert(gram_, order_);
    const auto re = gram_.topLeftCorner(N, N), im = gram_.bottomLeftCorner(N, N);
    V_.re.noalias() = W.re.lazyProduct(re);  // V = W (W^H W)^-1
    V_.re.noalias() -= W.im.lazyProduct(im);
    V_.im.noalias() = W.re.lazyProduct(im);
    V_.im.noalias() += W.im.lazyProduct(re);
    P_.re.noalias() = -V_.re.lazyProduct(W.re.transpose());  // I - V W^H, equation (7)
    P_.re.noalias() -= V_.im.lazyProduct(W.im.transpose());
    P_.im.noalias() = V_.re.lazyProduct(W.im.transpose());
    P_.im.noalias() -= V_.im.lazyProduct(W.re.transpose());
    for (Eigen::Index m = 0; m < M; ++m) P_.re(m, m) += Real(1);
    u_.setZero(M, 1);
    y_.setZero(M, 1);
  }
  AngularInnovation<Real> operator()(const SplitMatrix<Real>& a, const SplitMatrix<Real>& b, Eigen::Index n) {
    project(b, n, u_);  // equation (12)
    project(a, n, y_);
    const Real curvature = detail::real_product(u_, 0, u_, 0);
    return {-detail::real_product(u_, 0, y_, 0) / curvature, curvature};  // equation (13)
  }

 private:
  using Matrix = typename SplitMatrix<Real>::Matrix;
  void project(const SplitMatrix<Real>& v, Eigen::Index n, SplitMatrix<Real>& out) {
    out.re.noalias() = P_.re.lazyProduct(v.re.col(n));
    out.re.noalias() -= P_.im.lazyProduct(v.im.col(n));
    out.im.noalias() = P_.re.lazyProduct(v.im.col(n));
    out.im.noalias() += P_.im.lazyProduct(v.re.col(n));
  }
  Matrix gram_;
  SplitMatrix<Real> V_, P_, u_, y_;
  Eigen::VectorXi order_;
};

template <typename Real = double>
class ImplicitInnovation {
 public:
  void prepare(const SplitMatrix<Real>& W) {
    using std::sqrt;
    W_ = &W;
    const Eigen::Index N = W.cols();
    L_.setZero(N, N);
    inverse_.resize(N);
    for (Eigen::Index j = 0; j < N; ++j) {  // W^H W = L L^H
      for (Eigen::Index i = j; i < N; ++i) {
        Real re = W.re.col(i).dot(W.re.col(j)) + W.im.col(i).dot(W.im.col(j));
        Real im = i == j ? Real(0) : W.re.col(i).dot(W.im.col(j)) - W.im.col(i).dot(W.re.col(j));
        for (Eigen::Index k = 0; k < j; ++k) {
          re -= L_.re(i, k) * L_.re(j, k) + L_.im(i, k) * L_.im(j, k);
          if (i != j) im -= L_.im(i, k) * L_.re(j, k) - L_.re(i, k) * L_.im(j, k);
        }
        if (i == j) inverse_[j] = Real(1) / sqrt(re);
        L_.re(i, j) = re * inverse_[j];
        L_.im(i, j) = im * inverse_[j];
      }
    }
    ya_.setZero(N, 1);
    yb_.setZero(N, 1);
  }
  AngularInnovation<Real> operator()(const SplitMatrix<Real>& a, const SplitMatrix<Real>& b, Eigen::Index n) {
    coordinates(a, n, ya_);
    coordinates(b, n, yb_);
    const Real curvature = detail::real_product(b, n, b, n) - detail::real_product(yb_, 0, yb_, 0);
    return {-(detail::real_product(b, n, a, n) - detail::real_product(yb_, 0, ya_, 0)) / curvature, curvature};
  }

 private:
  using Matrix = typename SplitMatrix<Real>::Matrix;
  // y = L^-1 W^H v
  void coordinates(const SplitMatrix<Real>& v, Eigen::Index n, SplitMatrix<Real>& y) {
    for (Eigen::Index i = 0; i < W_->cols(); ++i) {
      Real re = W_->re.col(i).dot(v.re.col(n)) + W_->im.col(i).dot(v.im.col(n));
      Real im = W_->re.col(i).dot(v.im.col(n)) - W_->im.col(i).dot(v.re.col(n));
      for (Eigen::Index k = 0; k < i; ++k) {
        re -= L_.re(i, k) * y.re(k, 0) - L_.im(i, k) * y.im(k, 0);
        im -= L_.re(i, k) * y.im(k, 0) + L_.im(i, k) * y.re(k, 0);
      }
      y.re(i, 0) = re * inverse_[i];
      y.im(i, 0) = im * inverse_[i];
    }
  }
  const SplitMatrix<Real>* W_ = nullptr;
  SplitMatrix<Real> L_, ya_, yb_;
  Eigen::Matrix<Real, Eigen::Dynamic, 1> inverse_;
};

}  // namespace truebearing
