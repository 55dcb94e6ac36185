// SPDX-License-Identifier: Apache-2.0
#include "truebearing/evaluation/innovation_consistency.hpp"

#include <cmath>
#include <limits>

#include "truebearing/core/chi_square.hpp"

namespace truebearing {
namespace {

// Metres taken for kilometres, or degrees for radians, give thousands or thousandths; a badly chosen prior gives tens.
constexpr double kFarOff = 100.0;
// A NIS over its degrees of freedom that is smaller than this comes once in a hundred steps by chance.
constexpr double kStill = 1e-4;

// A part of z may be missing.
double freedom_of(const Innovation& innovation) {
  const bool told = innovation.z.size() == innovation.nu.size();
  return static_cast<double>(told ? innovation.z.array().isFinite().count() : innovation.nu.size());
}

}  // namespace

void InnovationConsistency::add(const StepRecord& record) {
  if (!record.innovation) return;
  const Innovation& innovation = *record.innovation;
  const double freedom = freedom_of(innovation);
  Track& track = tracks_[record.track];
  if (track.first_steps < kFirstSteps) {  // also those that a gate turned away: with a wrong unit it turns away all
    ++track.first_steps;
    ++first_steps_;
    first_freedom_ += freedom;
    first_nis_sum_ += innovation.nis;
  }
  if (record.status != StepStatus::ok) return;
  track.still_steps = innovation.nis < kStill * freedom ? track.still_steps + 1 : 0;
  stood_still_ |= track.still_steps >= kFirstSteps;
  ++steps_;
  freedom_ += freedom;
  nis_sum_ += innovation.nis;
  if (innovation.z.size() > 0 && !std::isfinite(innovation.z[0])) return;
  const double e = innovation.nu[0] / std::sqrt(innovation.S(0, 0));
  if (track.last_e) product_sum_ += e * *track.last_e;
  square_sum_ += e * e;
  track.last_e = e;
}

double InnovationConsistency::nis_ratio() const {
  return steps_ > 0 ? nis_sum_ / freedom_ : std::numeric_limits<double>::quiet_NaN();
}

double InnovationConsistency::nis_ratio_low() const {
  return chi_square_means(freedom_, 1.0).low;
}

double InnovationConsistency::nis_ratio_high() const {
  return chi_square_means(freedom_, 1.0).high;
}

double InnovationConsistency::correlation() const {
  return square_sum_ > 0.0 ? product_sum_ / square_sum_ : std::numeric_limits<double>::quiet_NaN();
}

double InnovationConsistency::correlation_limit() const {
  return steps_ > 1 ? normal_quantile(0.975) / std::sqrt(static_cast<double>(steps_))
                    : std::numeric_limits<double>::quiet_NaN();
}

bool InnovationConsistency::is_far_too_large_at_start() const {
  return first_steps_ > 0 && first_nis_sum_ > kFarOff * chi_square_quantile(0.975, first_freedom_);
}

bool InnovationConsistency::is_far_too_small() const {
  const bool at_start =
      first_steps_ >= kFirstSteps && first_nis_sum_ < chi_square_quantile(0.025, first_freedom_) / kFarOff;
  return at_start || stood_still_;
}

}  // namespace truebearing
