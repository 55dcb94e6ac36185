// SPDX-License-Identifier: Apache-2.0
#include "truebearing/tracker/particle_cloud.hpp"

#include <algorithm>
#include <cmath>
#include <complex>

#include "truebearing/core/angle.hpp"

namespace truebearing {
namespace {

using namespace kernels;

// Of the velocity that a particle begins with, in distances between neighbours: wide enough to leave no gaps, and far
// narrower than what the first measurements tell.
constexpr double kStartSpread = 4.0;
constexpr double kFastShare = 0.999;      // of the speeds that are drawn
constexpr double kLeastSpeed_mps = 1e-6;  // below which a velocity has no direction
constexpr double kGoldenRatio = 0.6180339887498949;

// M(a) and M(b) u u' of complex numbers a, b: multiplication by a, and by b of the part along the unit vector u.
void put(std::complex<double> a, std::complex<double> b, std::complex<double> u, double* to, std::size_t stride) {
  const std::complex<double> bu(b.real() * u.real() - b.imag() * u.imag(), b.real() * u.imag() + b.imag() * u.real());
  to[0] = a.real() + bu.real() * u.real();
  to[stride] = -a.imag() + bu.real() * u.imag();
  to[2 * stride] = a.imag() + bu.imag() * u.real();
  to[3 * stride] = a.real() + bu.imag() * u.imag();
}

}  // namespace

ParticleCloud::ParticleCloud(std::size_t particles)
    : count_(particles),
      stride_((particles + 7) / 8 * 8 + 8),  // rows do not lie a power of two apart
      modes_(particles),
      weight_(particles),
      rows_(kParticleRows * stride_),
      steps_(kStepRows * stride_),
      nis_(particles),
      scale_(particles) {}

void ParticleCloud::begin(const FlightModes& modes, const Eigen::Vector2d& z, const Eigen::Matrix2d& R, double flown_s,
                          RandomStream& stream) {
  const double n = static_cast<double>(count_);
  const double fast_mps = modes.flight().speed_mps.quantile(kFastShare);
  const double spread_mps = kStartSpread * fast_mps * std::sqrt(kPi / n);
  const double speed_offset = stream.uniform(), course_offset = stream.uniform();
  std::fill(rows_.begin(), rows_.end(), 0.0);
  for (std::size_t i = 0; i < count_; ++i) {
    double speed_mps = modes.flight().speed_mps.quantile((static_cast<double>(i) + speed_offset) / n);
    modes_[i] = modes.first(stream);
    weight_[i] = 1.0 / n;
    if (flown_s > 0.0) {
      const FlightStep flown = modes.advance(flown_s * stream.uniform(), speed_mps, modes_[i], stream);
      speed_mps += flown.gain;
      weight_[i] *= flown.weight;
    }
    const double course_rad = 2.0 * kPi * (course_offset + kGoldenRatio * static_cast<double>(i));
    row(p0)[i] = z[0];
    row(p1)[i] = z[1];
    row(v0)[i] = speed_mps * std::cos(course_rad);
    row(v1)[i] = speed_mps * std::sin(course_rad);
    row(pp00)[i] = R(0, 0);
    row(pp01)[i] = R(0, 1);
    row(pp11)[i] = R(1, 1);
    row(vv00)[i] = row(vv11)[i] = spread_mps * spread_mps;
  }
  effective_ = n;
}

void ParticleCloud::move(const ParticleCloud& from, const FlightModes& modes, double dt_s, RandomStream& stream) {
  using Complex = std::complex<double>;
  for (std::size_t i = 0; i < count_; ++i) {
    const double east_mps = from.row(v0)[i], north_mps = from.row(v1)[i];
    const double speed_mps = std::max(std::sqrt(east_mps * east_mps + north_mps * north_mps), kLeastSpeed_mps);
    modes_[i] = from.modes_[i];
    const FlightStep step = modes.advance(dt_s, speed_mps, modes_[i], stream);
    weight_[i] = from.weight_[i] * step.weight;
    const double grown = step.gain / speed_mps;
    const Complex glide = step.glide + step.drift / speed_mps, turn = step.turn * (1.0 + grown);
    const Complex u(east_mps / speed_mps, north_mps / speed_mps);
    put(glide, step.drift_slope - step.drift / speed_mps, u, &steps_[G00 * stride_ + i], stride_);
    put(turn, step.turn * (step.gain_slope - grown), u, &steps_[A00 * stride_ + i], stride_);
    row(p0)[i] = from.row(p0)[i] + glide.real() * east_mps - glide.imag() * north_mps;
    row(p1)[i] = from.row(p1)[i] + glide.real() * north_mps + glide.imag() * east_mps;
    row(v0)[i] = turn.real() * east_mps - turn.imag() * north_mps;
    row(v1)[i] = turn.real() * north_mps + turn.imag() * east_mps;
  }
  predict_particles(from.all(), steps_.data(), all());
}

bool ParticleCloud::update(const Eigen::Vector2d& z, const Eigen::Matrix2d& R) {
  update_particles(all(), {z[0], z[1], R(0, 0), R(0, 1), R(1, 1), nis_.data(), scale_.data()});
  // Weights are compared with that of the likeliest, so that a measurement far off is not mistaken for an impossible
  // one.
  const double least_nis = *std::min_element(nis_.begin(), nis_.end());
  double sum = 0.0;
  for (std::size_t i = 0; i < count_; ++i) {
    weight_[i] *= scale_[i] * std::exp(-0.5 * (nis_[i] - least_nis));
    sum += weight_[i];
  }
  if (!(sum > 0.0) || !std::isfinite(sum)) return false;
  double squares = 0.0;
  for (double& weight : weight_) {
    weight /= sum;
    squares += weight * weight;
  }
  effective_ = 1.0 / squares;
  return true;
}

void ParticleCloud::resample(const ParticleCloud& from, RandomStream& stream) {
  const double step = 1.0 / static_cast<double>(count_);
  double place = step * stream.uniform(), below = from.weight_[0];
  std::size_t chosen = 0;
  for (std::size_t i = 0; i < count_; ++i, place += step) {
    while (place >= below && chosen + 1 < count_) below += from.weight_[++chosen];
    modes_[i] = from.modes_[chosen];
    weight_[i] = step;
    for (std::size_t r = 0; r < kParticleRows; ++r) row(r)[i] = from.row(r)[chosen];
  }
  effective_ = static_cast<double>(count_);
}

ParticleCloud::Moments ParticleCloud::moments() const {
  const double origin[4] = {row(p0)[0], row(p1)[0], row(v0)[0], row(v1)[0]};
  double s[kMoments];
  particle_moments(all(), weight_.data(), origin, s);
  for (int k = kMoments - 1; k >= 0; --k) s[k] /= s[0];
  const Eigen::Vector4d mean(s[1], s[2], s[3], s[4]);
  Moments moments;
  moments.P << s[5], s[6], s[8], s[9],  //
      s[6], s[7], s[10], s[11],         //
      s[8], s[10], s[12], s[13],        //
      s[9], s[11], s[13], s[14];
  moments.P -= mean * mean.transpose();
  moments.x = mean + Eigen::Vector4d(origin[0], origin[1], origin[2], origin[3]);
  return moments;
}

Eigen::Vector3d ParticleCloud::mode_probabilities() const {
  Eigen::Vector3d sums = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < count_; ++i)
    sums[modes_[i].kind == FlightMode::Kind::turn           ? 1
         : modes_[i].kind == FlightMode::Kind::acceleration ? 2
                                                            : 0] += weight_[i];
  return sums / sums.sum();
}

}  // namespace truebearing
