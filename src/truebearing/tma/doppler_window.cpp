// SPDX-License-Identifier: Apache-2.0
#include "truebearing/tma/doppler_window.hpp"

#include <algorithm>

namespace truebearing {
namespace {

// Until it is solved, a source holds its sums: of w g f, of w g^2 and of w g dg/dx.
void sum(double w, double frequency_hz, const DopplerWindow::Shift& g, SourceFrequency& source) {
  source.frequency_hz += w * g.value * frequency_hz;
  source.variance += w * g.value * g.value;
  source.per_state += w * g.value * g.per_state;
}
void solve(SourceFrequency& source) {
  source.variance = 1.0 / source.variance;
  source.frequency_hz *= source.variance;
  source.per_state *= -source.frequency_hz * source.variance;
}

}  // namespace

Eigen::Matrix<double, 5, 5> covariance_with(const Eigen::Matrix4d& P, const SourceFrequency& source) {
  Eigen::Matrix<double, 5, 5> whole;
  whole.topLeftCorner<4, 4>() = P;
  whole.bottomLeftCorner<1, 4>() = source.per_state * P;
  whole.topRightCorner<4, 1>() = whole.bottomLeftCorner<1, 4>().transpose();
  whole(4, 4) = source.variance_with(P);
  return whole;
}

void DopplerWindow::add(double time_s, double frequency_hz, double sigma_hz, const SensorState& sensor) {
  level_.push_back(level_.empty() ? 0 : level_.back());
  levels_ = std::max(levels_, 1);
  time_s_.push_back(time_s);
  frequency_hz_.push_back(frequency_hz);
  sigma_hz_.push_back(sigma_hz);
  sensor_.push_back(sensor);
}

void DopplerWindow::drop_before(double time_s) {
  const auto count = std::lower_bound(time_s_.begin(), time_s_.end(), time_s) - time_s_.begin();
  if (count == 0) return;
  for (std::vector<double>* column : {&time_s_, &frequency_hz_, &sigma_hz_})
    column->erase(column->begin(), column->begin() + count);
  sensor_.erase(sensor_.begin(), sensor_.begin() + count);
  level_.erase(level_.begin(), level_.begin() + count);
  renumber();
}

void DopplerWindow::clear() {
  for (std::vector<double>* column : {&time_s_, &frequency_hz_, &sigma_hz_}) column->clear();
  sensor_.clear();
  level_.clear();
  levels_ = 0;
}

void DopplerWindow::reserve(std::size_t count) {
  for (std::vector<double>* column : {&time_s_, &frequency_hz_, &sigma_hz_}) column->reserve(count);
  sensor_.reserve(count);
  level_.reserve(count);
  number_.reserve(count);
}

void DopplerWindow::set_levels(std::span<const int> level) {
  level_.assign(level.begin(), level.end());
  renumber();
}

void DopplerWindow::renumber() {
  levels_ = 0;
  if (level_.empty()) return;
  number_.assign(static_cast<std::size_t>(*std::max_element(level_.begin(), level_.end())) + 1, -1);
  for (int& level : level_) {
    int& number = number_[static_cast<std::size_t>(level)];
    if (number < 0) number = levels_++;
    level = number;
  }
}

DopplerWindow::Shift DopplerWindow::shift(std::size_t i, const Eigen::Vector4d& x, double origin_s) const {
  const double t = time_s_[i] - origin_s;
  const Eigen::Vector2d offset_m = x.head<2>() + t * x.tail<2>() - sensor_[i].position_m;
  const Eigen::Vector2d v = x.tail<2>() - sensor_[i].velocity_mps;
  const double range_m = offset_m.norm();
  const Eigen::Vector2d u = offset_m / range_m, across(u.y(), -u.x());
  // dv_r = u . dv + (v . du), and du = across (across . d offset) / r.
  const Eigen::RowVector2d of_place = v.dot(across) / range_m * across.transpose();
  Shift shift;
  shift.value = 1.0 - v.dot(u) / sound_mps_;
  shift.per_state << of_place, t * of_place + u.transpose();
  shift.per_state /= -sound_mps_;
  return shift;
}

SourceFrequency DopplerWindow::source(int level, const Eigen::Vector4d& x, double origin_s) const {
  SourceFrequency source;
  for (std::size_t i = 0; i < size(); ++i)
    if (level_[i] == level) sum(weight(i), frequency_hz_[i], shift(i, x, origin_s), source);
  solve(source);
  return source;
}

void DopplerWindow::sources(const Eigen::Vector4d& x, double origin_s, std::vector<SourceFrequency>& sources) const {
  sources.assign(static_cast<std::size_t>(levels_), {});
  for (std::size_t i = 0; i < size(); ++i)
    sum(weight(i), frequency_hz_[i], shift(i, x, origin_s), sources[static_cast<std::size_t>(level_[i])]);
  for (SourceFrequency& source : sources) solve(source);
}

}  // namespace truebearing
