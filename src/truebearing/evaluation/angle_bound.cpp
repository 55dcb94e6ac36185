// SPDX-License-Identifier: Apache-2.0
#include "truebearing/evaluation/angle_bound.hpp"

#include <cmath>
#include <limits>
#include <optional>

#include "truebearing/array/angle_information.hpp"
#include "truebearing/array/interval.hpp"
#include "truebearing/core/error.hpp"
#include "truebearing/measurement/posterior_information.hpp"
#include "truebearing/motion/constant_velocity.hpp"

namespace truebearing {
namespace {

constexpr const char* kAngleBound = "scoring.angle_bound";
constexpr double kSquareDegree = radians(1.0) * radians(1.0);
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

void check_snapshots(const Recording& recording) {
  if (!measures_snapshots(recording.measured))
    throw InputError(kAngleBound, "finds no snapshots in the recording", "a line array's");
  if (!recording.truth_space || *recording.truth_space != angle_space() || recording.truth.empty())
    throw InputError(kAngleBound, "finds no truth of angles in the recording");
  for (const Truth& target : recording.truth)
    if (!target.snr)
      throw InputError(kAngleBound, "finds a target in the recording whose signal-to-noise ratio is not told",
                       "a simulated line array");
}

// Who is there in a step.
std::vector<std::size_t> targets_at(const Recording& recording, std::size_t step) {
  std::vector<std::size_t> there;
  for (std::size_t target = 0; target < recording.truth.size(); ++target)
    if (std::isfinite(recording.truth[target].x[step][0])) there.push_back(target);
  return there;
}

// The information of [angle, rate] of each target, in the order in which they were first heard.
class AnglePosterior {
 public:
  AnglePosterior(const AngleBound& bound, std::size_t targets)
      : motion_{{bound.q_rad2ps3}}, rate_sigma_radps_(bound.rate_sigma_radps), place_(targets, -1) {}

  void predict(double dt_s) {
    const Eigen::Index n = information_.J().rows();
    if (n == 0) return;
    Eigen::MatrixXd F = Eigen::MatrixXd::Zero(n, n), Q = F;
    for (Eigen::Index i = 0; i < n; i += 2) {
      F.block<2, 2>(i, i) = motion_.F(dt_s);
      Q.block<2, 2>(i, i) = motion_.Q(dt_s);
    }
    information_.predict(F, Q);
  }

  // J: of the angles of those that are there.
  void add(const std::vector<std::size_t>& there, const Eigen::MatrixXd& J) {
    for (const std::size_t target : there)
      if (place_[target] < 0) begin(target);
    Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(information_.J().rows(), information_.J().cols());
    for (std::size_t j = 0; j < there.size(); ++j)
      for (std::size_t i = 0; i < there.size(); ++i)
        sum(place_[there[i]], place_[there[j]]) = J(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j));
    information_.add(sum);
  }

  std::optional<Eigen::MatrixXd> covariance() const {
    if (information_.J().rows() == 0) return std::nullopt;
    return information_.covariance();
  }
  // Of a target's angle in it, with the rate after it; -1 before it was heard.
  Eigen::Index place(std::size_t target) const { return place_[target]; }

 private:
  void begin(std::size_t target) {
    place_[target] = information_.J().rows();
    information_.add_parameter();
    information_.add_parameter();
    Eigen::MatrixXd prior = Eigen::MatrixXd::Zero(information_.J().rows(), information_.J().cols());
    prior(place_[target] + 1, place_[target] + 1) = 1.0 / (rate_sigma_radps_ * rate_sigma_radps_);
    information_.add(prior);
  }

  ConstantVelocity<1, ContinuousWhiteNoise> motion_;
  double rate_sigma_radps_;
  std::vector<Eigen::Index> place_;  // [target]
  PosteriorInformation<Eigen::Dynamic> information_{0};
};

bool is_apart(const Eigen::VectorXd& angles_rad, Eigen::Index target, double apart_rad) {
  for (Eigen::Index other = 0; other < angles_rad.size(); ++other)
    if (other != target && !(std::abs(angles_rad[other] - angles_rad[target]) > apart_rad)) return false;
  return true;
}

}  // namespace

AngleVariances AngleBound::variances(const Recording& recording, int from_step) const {
  check_snapshots(recording);
  const std::size_t steps = recording.measurements.size(), places = recording.truth.size() * steps;
  AngleVariances variances;
  variances.targets = recording.truth.size();
  variances.apart.assign(places, false);
  for (std::vector<double>* values :
       {&variances.cramer_rao_deg2, &variances.posterior_deg2, &variances.posterior_deg2ps2})
    values->assign(places, kNone);

  AnglePosterior posterior(*this, recording.truth.size());
  Interval interval;
  for (std::size_t step = 0; step < steps; ++step) {
    const Measurement& measurement = recording.measurements[step];
    if (step > 0) posterior.predict(measurement.time_s - recording.measurements[step - 1].time_s);
    const std::vector<std::size_t> there = targets_at(recording, step);
    const auto N = static_cast<Eigen::Index>(there.size());
    Eigen::VectorXd angles_rad(N), snr(N), alone;  // alone: of the interval by itself
    for (Eigen::Index n = 0; n < N; ++n) {
      const Truth& target = recording.truth[there[static_cast<std::size_t>(n)]];
      angles_rad[n] = target.x[step][0];
      snr[n] = *target.snr;
    }
    if (measurement.snapshots) interval.take(*measurement.snapshots);
    if (N > 0 && measurement.snapshots && interval.is_usable()) {
      const LineArray array{interval.sensors(), interval.spacing_wavelengths()};
      const AngleInformation J = angle_information(array, angles_rad, snr, interval.snapshots(), interval.live());
      alone = J.angle_variances_rad2();
      posterior.add(there, J.powers_known());
    }
    if (static_cast<int>(step) + 1 < from_step) continue;
    const std::optional<Eigen::MatrixXd> P = posterior.covariance();
    for (Eigen::Index n = 0; n < N; ++n) {
      const std::size_t target = there[static_cast<std::size_t>(n)], place = target * steps + step;
      variances.apart[place] = is_apart(angles_rad, n, apart_rad);
      if (alone.size() > 0) variances.cramer_rao_deg2[place] = alone[n] / kSquareDegree;
      const Eigen::Index at = posterior.place(target);
      if (!P || at < 0) continue;
      variances.posterior_deg2[place] = (*P)(at, at) / kSquareDegree;
      variances.posterior_deg2ps2[place] = (*P)(at + 1, at + 1) / kSquareDegree;
    }
  }
  return variances;
}

}  // namespace truebearing
