// SPDX-License-Identifier: Apache-2.0
#include "truebearing/tma/doppler_term.hpp"

#include "truebearing/tma/bearing_sums.hpp"

namespace truebearing {

void DopplerTerm::look_at(const ModifiedPolar& polar, const DopplerWindow* window) {
  const std::size_t m = window ? window->size() : 0, count = window ? static_cast<std::size_t>(window->levels()) : 0;
  for (std::vector<double>* column : {&time_s_, &above_hz_, &weight_, &east_m_, &north_m_, &east_mps_, &north_mps_})
    column->resize(m);
  levels_.assign(count, {0, 0.0});
  if (m == 0) return;
  sound_mps_ = window->sound_mps();
  for (std::size_t i = 0; i < m; ++i) {
    Level& level = levels_[static_cast<std::size_t>(window->level(i))];
    ++level.end;
    level.mean_hz += window->frequency_hz(i);
  }
  std::size_t begin = 0;
  for (Level& level : levels_) {
    level.mean_hz /= static_cast<double>(level.end);
    const std::size_t size = level.end;
    level.end = begin;  // grows to its end as the level fills
    begin += size;
  }
  for (std::size_t i = 0; i < m; ++i) {
    Level& level = levels_[static_cast<std::size_t>(window->level(i))];
    const SensorState& sensor = window->sensor(i);
    const double t = window->time_s(i) - polar.origin_s();
    const Eigen::Vector2d d = sensor.position_m - polar.line_m() - t * polar.line_mps();
    const Eigen::Vector2d e = sensor.velocity_mps - polar.line_mps();
    const std::size_t k = level.end++;
    time_s_[k] = t;
    above_hz_[k] = window->frequency_hz(i) - level.mean_hz;
    weight_[k] = window->weight(i);
    east_m_[k] = d.x();
    north_m_[k] = d.y();
    east_mps_[k] = e.x();
    north_mps_[k] = e.y();
  }
}

void DopplerTerm::add(const Eigen::Vector4d& y, NormalEquations<4>& equations) const {
  std::size_t begin = 0;
  for (const Level& level : levels_) {
    const FrequencySums sums =
        frequency_sums({level.end - begin, &time_s_[begin], &above_hz_[begin], &weight_[begin], &east_m_[begin],
                        &north_m_[begin], &east_mps_[begin], &north_mps_[begin]},
                       y.data(), level.mean_hz, sound_mps_);
    begin = level.end;
    // With f0 = mean + phi the residual is r - phi (1 - q), and the best phi is where that has no part in 1 - q.
    const double phi = sums.product / sums.information, f0 = level.mean_hz + phi;
    const Eigen::Map<const Eigen::Vector4d> of_residual(sums.of_residual), of_shift(sums.of_shift);
    equations.cost += 0.5 * (sums.squares - phi * sums.product);
    equations.gradient -= f0 * (of_residual - phi * of_shift);
    for (int row = 0, k = 0; row < 4; ++row)
      for (int column = 0; column <= row; ++column, ++k) {
        const double share = f0 * f0 * (sums.of_state[k] - of_shift[row] * of_shift[column] / sums.information);
        equations.A(row, column) += share;
        if (column < row) equations.A(column, row) += share;
      }
  }
}

}  // namespace truebearing
