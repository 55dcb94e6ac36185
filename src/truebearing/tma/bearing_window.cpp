// SPDX-License-Identifier: Apache-2.0
#include "truebearing/tma/bearing_window.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "truebearing/tma/bearing_sums.hpp"
#include "truebearing/core/angle.hpp"

namespace truebearing {

void BearingWindow::add(double time_s, double bearing_rad, double sigma_rad, const Eigen::Vector2d& site_m) {
  time_s_.push_back(time_s);
  bearing_rad_.push_back(bearing_rad);
  sine_.push_back(std::sin(bearing_rad));
  cosine_.push_back(std::cos(bearing_rad));
  weight_.push_back(1.0 / (sigma_rad * sigma_rad));
  east_m_.push_back(site_m.x());
  north_m_.push_back(site_m.y());
}

void BearingWindow::drop_before(double time_s) {
  const auto count = std::lower_bound(time_s_.begin(), time_s_.end(), time_s) - time_s_.begin();
  for (std::vector<double>* column : {&time_s_, &bearing_rad_, &sine_, &cosine_, &weight_, &east_m_, &north_m_})
    column->erase(column->begin(), column->begin() + count);
}

BearingWindow BearingWindow::without(std::span<const std::size_t> left_out) const {
  BearingWindow rest;
  rest.reserve(size());
  for (std::size_t i = 0; i < size(); ++i) {
    if (!left_out.empty() && left_out.front() == i)
      left_out = left_out.subspan(1);
    else
      rest.add(time_s_[i], bearing_rad_[i], 1.0 / std::sqrt(weight_[i]), site_m(i));
  }
  return rest;
}

void BearingWindow::clear() {
  for (std::vector<double>* column : {&time_s_, &bearing_rad_, &sine_, &cosine_, &weight_, &east_m_, &north_m_})
    column->clear();
}

void BearingWindow::reserve(std::size_t count) {
  for (std::vector<double>* column : {&time_s_, &bearing_rad_, &sine_, &cosine_, &weight_, &east_m_, &north_m_})
    column->reserve(count);
}

BearingArrays BearingWindow::arrays() const {
  return {size(), time_s_.data(), sine_.data(), cosine_.data(), weight_.data(), east_m_.data(), north_m_.data()};
}

NormalEquations<4> BearingWindow::cartesian(const Eigen::Vector4d& x0, double origin_s) const {
  const CartesianSums sums = cartesian_sums(arrays(), x0.data(), origin_s);
  // J = [a, b, a t, b t] with a = dy / r^2, b = -dx / r^2: nine sums make J'WJ.
  NormalEquations<4> equations;
  equations.cost = sums.cost;
  equations.gradient << sums.ra, sums.rb, sums.rat, sums.rbt;
  equations.A << sums.aa, sums.ab, sums.aat, sums.abt,  //
      sums.ab, sums.bb, sums.abt, sums.bbt,             //
      sums.aat, sums.abt, sums.aatt, sums.abtt,         //
      sums.abt, sums.bbt, sums.abtt, sums.bbtt;
  return equations;
}

double BearingWindow::residual(std::size_t i, const Eigen::Vector4d& x0, double origin_s) const {
  const Eigen::Vector2d d = x0.head<2>() + (time_s_[i] - origin_s) * x0.tail<2>() - site_m(i);
  return wrap_pi(bearing_rad_[i] - std::atan2(d.x(), d.y()));
}

Eigen::RowVector4d BearingWindow::jacobian(std::size_t i, const Eigen::Vector4d& x0, double origin_s) const {
  const double t = time_s_[i] - origin_s;
  const Eigen::Vector2d d = x0.head<2>() + t * x0.tail<2>() - site_m(i);
  const double a = d.y() / d.squaredNorm(), b = -d.x() / d.squaredNorm();
  return {a, b, a * t, b * t};
}

}  // namespace truebearing
