// SPDX-License-Identifier: Apache-2.0
#include "truebearing/tma/motion_rows.hpp"

#include <algorithm>
#include <cmath>

#include "truebearing/core/angle.hpp"
#include "truebearing/core/linear_algebra.hpp"

namespace truebearing {

MotionRows::MotionRows(const BearingWindow& bearings, const DopplerWindow* frequencies)
    : bearings_(bearings), frequencies_(frequencies) {
  polar_.look_at(bearings);
  rows_.reserve(bearings.size() + (frequencies ? frequencies->size() : 0));
}

void MotionRows::look_at(const Eigen::Vector4d& y, const Eigen::Vector2d& dv_mps, double change_s) {
  const Eigen::Vector4d x = polar_.to_cartesian(y);
  const Eigen::Matrix4d T = polar_.jacobian(y);
  rows_.clear();
  for (std::size_t i = 0; i < bearings_.size(); ++i) {
    const double time_s = bearings_.time_s(i), t = time_s - polar_.origin_s(),
                 since_s = std::max(time_s - change_s, 0.0);
    const Eigen::Vector2d d = x.head<2>() + t * x.tail<2>() + since_s * dv_mps - bearings_.site_m(i);
    const double per_unit = std::sqrt(bearings_.weight(i));
    const Eigen::RowVector2d place = per_unit / d.squaredNorm() * Eigen::RowVector2d(d.y(), -d.x());
    rows_.push_back({.time_s = time_s,
                     .residual = per_unit * wrap_pi(bearings_.bearing_rad(i) - std::atan2(d.x(), d.y())),
                     .per_unit = per_unit,
                     .of_y = place * (T.topRows<2>() + t * T.bottomRows<2>()),
                     .of_place = place,
                     .of_velocity = Eigen::RowVector2d::Zero(),
                     .level = -1,
                     .of_f0 = 0.0});
  }
  if (frequencies_) look_at_frequencies(x, T, dv_mps, change_s);
}

void MotionRows::look_at_frequencies(const Eigen::Vector4d& x, const Eigen::Matrix4d& T, const Eigen::Vector2d& dv_mps,
                                     double change_s) {
  const DopplerWindow& window = *frequencies_;
  level_.assign(static_cast<std::size_t>(window.levels()), {0.0, 0.0});
  for (std::size_t i = 0; i < window.size(); ++i) {
    const double time_s = window.time_s(i), t = time_s - polar_.origin_s();
    Eigen::Vector4d now = x;
    now.head<2>() += t * x.tail<2>();
    if (time_s > change_s) now += (Eigen::Vector4d() << (time_s - change_s) * dv_mps, dv_mps).finished();
    const DopplerWindow::Shift shift = window.shift(i, now, time_s);
    const double per_unit = 1.0 / window.sigma_hz(i);
    const Eigen::RowVector4d per_state = per_unit * shift.per_state;
    Level& level = level_[static_cast<std::size_t>(window.level(i))];
    level.product += per_unit * per_unit * shift.value * window.frequency_hz(i);
    level.information += per_unit * per_unit * shift.value * shift.value;
    const Eigen::RowVector2d place = per_state.head<2>(), velocity = per_state.tail<2>();
    rows_.push_back({.time_s = time_s,
                     .residual = per_unit * window.frequency_hz(i),  // until f0 is known
                     .per_unit = per_unit,
                     .of_y = place * T.topRows<2>() + (t * place + velocity) * T.bottomRows<2>(),
                     .of_place = place,
                     .of_velocity = velocity,
                     .level = window.level(i),
                     .of_f0 = per_unit * shift.value});
  }
  for (MotionRow& row : std::span(rows_).subspan(bearings_.size())) {
    const Level& level = level_[static_cast<std::size_t>(row.level)];
    const double f0 = level.product / level.information;
    row.residual -= f0 * row.of_f0;
    row.of_y *= f0;
    row.of_place *= f0;
    row.of_velocity *= f0;
  }
}

NormalEquations<6> MotionRows::equations(double change_s) const {
  return equations<6>([&](const MotionRow& row) {
    Eigen::Matrix<double, 1, 6> j;
    j << row.of_y, row.of_change(change_s);
    return j;
  });
}

std::vector<double> MotionRows::leverages(const Eigen::Matrix4d& P) const {
  std::vector<Eigen::RowVector4d> of_level(level_.size(), Eigen::RowVector4d::Zero());
  for (const MotionRow& row : frequencies()) of_level[static_cast<std::size_t>(row.level)] += row.of_f0 * row.of_y;
  std::vector<double> leverages;
  leverages.reserve(rows_.size());
  for (const MotionRow& row : rows_) {
    Eigen::RowVector4d j = row.of_y;
    double own = 0.0;
    if (row.level >= 0) {
      const auto l = static_cast<std::size_t>(row.level);
      j -= row.of_f0 / level_[l].information * of_level[l];
      own = row.of_f0 * row.of_f0 / level_[l].information;
    }
    leverages.push_back(own + j.dot(j * P));
  }
  return leverages;
}

Eigen::Vector4d polar_of(const BatchEstimate& estimate, const ModifiedPolar& polar) {
  Eigen::Vector4d x = estimate.x;
  x.head<2>() -= (estimate.time_s - polar.origin_s()) * x.tail<2>();
  return polar.from_cartesian(x);
}

template <int N>
Eigen::Matrix<double, N, N> root_of_inverse(const Eigen::Matrix<double, N, N>& information) {
  constexpr double kLeast = 1e-11;
  const Eigen::Matrix<double, N, 1> scale = information.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  constexpr int kSize = N > 4 ? Eigen::Dynamic : N;  // of modes that are compiled
  const Eigen::Matrix<double, kSize, kSize> scaled = scale.asDiagonal() * information * scale.asDiagonal();
  const SymmetricModes<kSize> modes = symmetric_modes<kSize>(scaled);
  Eigen::Matrix<double, N, 1> inverse = Eigen::Matrix<double, N, 1>::Zero();
  for (int i = 0; i < N; ++i)
    if (modes.values[i] > kLeast) inverse[i] = 1.0 / modes.values[i];
  return scale.asDiagonal() * modes.vectors * inverse.cwiseSqrt().asDiagonal();
}
template Eigen::Matrix<double, 4, 4> root_of_inverse<4>(const Eigen::Matrix<double, 4, 4>&);
template Eigen::Matrix<double, 6, 6> root_of_inverse<6>(const Eigen::Matrix<double, 6, 6>&);

Eigen::Matrix4d inverse_of_what_is_known(const Eigen::Matrix4d& information) {
  const Eigen::Matrix4d root = root_of_inverse<4>(information);
  return root * root.transpose();
}

}  // namespace truebearing
