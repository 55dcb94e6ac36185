#include "truebearing/array/projection_approximation.hpp"

#include "truebearing/array/simd_dispatch.hpp"

namespace truebearing {
namespace {

struct Past {
  int rows, columns;  // of W, rows padded
  double beta;
  int snapshots;
  const double *x_re, *x_im;  // (rows x snapshots)
  double *e_re, *e_im;
  double *W_re, *W_im, *P_re, *P_im;
  double *y_re, *y_im, *h_re, *h_im;
};

[[gnu::always_inline]] inline void step(const Past& s, const double* x_re, const double* x_im) {
  const int M = s.rows, N = s.columns;
  for (int n = 0; n < N; ++n) {  // y = W^H x
    const double *re = s.W_re + n * M, *im = s.W_im + n * M;
    double y_re = 0.0, y_im = 0.0;
#pragma omp simd reduction(+ : y_re, y_im)
    for (int m = 0; m < M; ++m) {
      y_re += re[m] * x_re[m] + im[m] * x_im[m];
      y_im += re[m] * x_im[m] - im[m] * x_re[m];
    }
    s.y_re[n] = y_re;
    s.y_im[n] = y_im;
  }
  for (int n = 0; n < N; ++n) s.h_re[n] = s.h_im[n] = 0.0;
  for (int j = 0; j < N; ++j) {  // h = P y
    const double *re = s.P_re + j * N, *im = s.P_im + j * N;
    for (int i = 0; i < N; ++i) {
      s.h_re[i] += re[i] * s.y_re[j] - im[i] * s.y_im[j];
      s.h_im[i] += re[i] * s.y_im[j] + im[i] * s.y_re[j];
    }
  }
  double power = s.beta;  // beta + y^H h, real as P is Hermitian
  for (int n = 0; n < N; ++n) power += s.y_re[n] * s.h_re[n] + s.y_im[n] * s.h_im[n];
  const double inverse = 1.0 / power, forget = 1.0 / s.beta;

  double *e_re = s.e_re, *e_im = s.e_im;  // e = x - W y
#pragma omp simd
  for (int m = 0; m < M; ++m) {
    e_re[m] = x_re[m];
    e_im[m] = x_im[m];
  }
  for (int n = 0; n < N; ++n) {
    const double *re = s.W_re + n * M, *im = s.W_im + n * M;
    const double y_re = s.y_re[n], y_im = s.y_im[n];
#pragma omp simd
    for (int m = 0; m < M; ++m) {
      e_re[m] -= re[m] * y_re - im[m] * y_im;
      e_im[m] -= re[m] * y_im + im[m] * y_re;
    }
  }
  for (int n = 0; n < N; ++n) {  // W = W + e g^H
    double *re = s.W_re + n * M, *im = s.W_im + n * M;
    const double g_re = s.h_re[n] * inverse, g_im = s.h_im[n] * inverse;
#pragma omp simd
    for (int m = 0; m < M; ++m) {
      re[m] += e_re[m] * g_re + e_im[m] * g_im;
      im[m] += e_im[m] * g_re - e_re[m] * g_im;
    }
  }
  for (int j = 0; j < N; ++j) {  // P = Tri{P - g h^H} / beta
    double *re = s.P_re + j * N, *im = s.P_im + j * N;
    const double h_re = s.h_re[j] * inverse, h_im = s.h_im[j] * inverse;
    for (int i = j; i < N; ++i) {
      re[i] = forget * (re[i] - (s.h_re[i] * h_re + s.h_im[i] * h_im));
      im[i] = forget * (im[i] - (s.h_im[i] * h_re - s.h_re[i] * h_im));
      s.P_re[i * N + j] = re[i];
      s.P_im[i * N + j] = -im[i];
    }
    im[j] = 0.0;
  }
}
[[gnu::always_inline]] inline void past_loops(const Past& s) {
  for (int t = 0; t < s.snapshots; ++t) step(s, s.x_re + t * s.rows, s.x_im + t * s.rows);
}
TRUEBEARING_FOR_AVX2(past, (const Past& s), (s))

}  // namespace

void ProjectionApproximation::begin(const Eigen::MatrixXcd& basis) {
  const Eigen::Index M = basis.rows(), padded = Interval::padded(static_cast<int>(M)), N = basis.cols();
  W_.setZero(padded, N);
  W_.re.topRows(M) = basis.real();
  W_.im.topRows(M) = basis.imag();
  P_.re.setIdentity(N, N);
  P_.im.setZero(N, N);
  e_.setZero(2 * padded);
  work_.setZero(4 * N);
}

void ProjectionApproximation::update(const Interval& interval) {
  const Eigen::Index M = W_.rows(), N = W_.cols();
  past({static_cast<int>(M), static_cast<int>(N), beta_, interval.snapshots(), interval.re(0), interval.im(0),
        e_.data(), e_.data() + M, W_.re.data(), W_.im.data(), P_.re.data(), P_.im.data(), work_.data(),
        work_.data() + N, work_.data() + 2 * N, work_.data() + 3 * N});
}

}  // namespace truebearing
