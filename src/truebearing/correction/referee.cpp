// SPDX-License-Identifier: Apache-2.0
#include "truebearing/correction/referee.hpp"

#include <cmath>
#include <type_traits>

#include "truebearing/core/with_count.hpp"

namespace truebearing {

void Referee::judge(const StepRecord& base, const RefereeOptions& options) {
  if (base.status != StepStatus::ok || !base.innovation) return;
  const Eigen::Index m = base.x.size() / 2;
  if (base.innovation->z.size() != m) return;
  with_count(static_cast<int>(m), [&]<int M>(std::integral_constant<int, M>) {
    if constexpr (M >= 1 && 2 * M <= kMaxDimension) {
      judge_position<M>(base, options);
      judge_velocity<M>(base, options);
    }
  });
}

template <int M>
void Referee::judge_position(const StepRecord& base, const RefereeOptions& options) {
  const Estimates* last = ago(1);
  if (!last || last->states != 2 * M || !(base.time_s > last->time_s)) return;
  const double* const z = base.innovation->z.data();
  const double dt_s = base.time_s - last->time_s;
  const double claimed = base.innovation->S.trace() + dt_s * dt_s * last->velocity_variance;
  double corrected = 0.0, reference = 0.0;
  for (int i = 0; i < M; ++i) {
    const double moved = dt_s * last->published[M + i];
    const double of_corrected = z[i] - last->corrected[i] - moved, of_reference = z[i] - last->reference[i] - moved;
    corrected += of_corrected * of_corrected;
    reference += of_reference * of_reference;
  }
  take(position_, corrected / claimed, reference / claimed, options.alpha);
}

template <int M>
void Referee::judge_velocity(const StepRecord& base, const RefereeOptions& options) {
  const double* const z = base.innovation->z.data();
  const double measured = base.innovation->S.trace();
  // Each parabola counts by how much of what differs there is the estimate's own error, as far as is claimed.
  std::array<double, kHalfWidths.size()> told{}, corrected{}, reference{};
  double all_told = 0.0;
#pragma GCC unroll 1  // a step that is longer than the cache of instructions pays for each that stands there twice
  for (std::size_t i = 0; i < kHalfWidths.size(); ++i) {
    const Estimates* then = ago(kHalfWidths[i]);
    const Estimates* before = ago(2 * kHalfWidths[i]);
    if (!before || before->states / 2 != M || then->states / 2 != M) break;
    const double h1 = then->time_s - before->time_s, h2 = base.time_s - then->time_s;
    if (!(h1 > 0.0) || !(h2 > 0.0)) break;
    // The derivative of Lagrange's parabola at its middle point.
    const double scale = 1.0 / (h1 * h2 * (h1 + h2));
    const double w1 = -(h2 * h2) * scale, w2 = h1 * h1 * scale, w0 = -w1 - w2;
    const double claimed = then->velocity_variance + (w1 * w1 + w0 * w0 + w2 * w2) * measured;
    const double share = 1.0 / claimed;
    const double *of_corrected = then->corrected + then->states - M, *of_reference = then->reference + then->states - M;
    for (int k = 0; k < M; ++k) {
      const double slope = w1 * before->z[k] + w0 * then->z[k] + w2 * z[k];
      corrected[i] += (slope - of_corrected[k]) * (slope - of_corrected[k]);
      reference[i] += (slope - of_reference[k]) * (slope - of_reference[k]);
    }
    corrected[i] *= share;
    reference[i] *= share;
    told[i] = then->velocity_variance * share;
    all_told += told[i];
  }
  if (!(all_told > 0.0)) return;
  const double alpha = options.alpha / all_told;
  for (std::size_t i = 0; i < kHalfWidths.size() && told[i] > 0.0; ++i)
    take(velocity_, corrected[i], reference[i], alpha * told[i]);
}

double Referee::weight(const Averages& averages, const RefereeOptions& options) {
  if (!averages.started) return 1.0;
  const double ratio = averages.corrected / averages.reference;
  const double weight = 1.0 / (1.0 + std::exp((ratio - options.tolerance) / options.edge));
  return std::isfinite(weight) ? weight : 0.0;
}

}  // namespace truebearing
