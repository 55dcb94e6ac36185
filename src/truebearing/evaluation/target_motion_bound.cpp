// SPDX-License-Identifier: Apache-2.0
#include "truebearing/evaluation/target_motion_bound.hpp"

#include <cmath>
#include <fmt/format.h>
#include <string>

#include "truebearing/core/error.hpp"
#include "truebearing/measurement/posterior_information.hpp"
#include "truebearing/measurement/bearing.hpp"
#include "truebearing/measurement/range_bearing_rate.hpp"
#include "truebearing/motion/constant_velocity.hpp"

namespace truebearing {
namespace {

constexpr const char* kBound = "scoring.bound";

constexpr Eigen::Index kFrequencyRow = 4;  // its place in a true state that has one

bool uses_frequencies(const TargetMotionBound& bound, const Recording& recording) {
  return bound.frequencies && measures_bearing_and_frequency(recording.measured);
}

bool is_of_radar(const Recording& recording) {
  return recording.measured == Measured::range_bearing().components ||
         recording.measured == RangeBearingRate<>::measured().components;
}

void check_measured(const TargetMotionBound& bound, const Recording& recording) {
  if (!recording.sources.empty())
    throw InputError(kBound, "cannot be made for several sensors", "a scenario or a log of one");
  if (recording.measured != std::vector<std::string>{"bearing_deg"} &&
      !measures_bearing_and_frequency(recording.measured) && !is_of_radar(recording))
    throw InputError(
        kBound, fmt::format("cannot be made for {}", fmt::join(recording.measured, ", ")),
        "bearing_deg with frequency_hz or without, or range_m and bearing_deg with range_rate_mps or without");
  if (!recording.truth_space || !begins_in_plane(*recording.truth_space) || recording.truth.size() != 1)
    throw InputError(kBound, "needs the truth of one target in the plane");
  if (uses_frequencies(bound, recording) && recording.truth_space != &plane_frequency_space())
    throw InputError(kBound, "needs the true frequency of the source", "truth_frequency_hz, or frequencies = false");
}

// How many steps the truth keeps its first velocity, as far as it is known.
std::size_t steady_steps(const std::vector<BoundedVector>& truth) {
  constexpr double kTolerance_mps = 1e-3;
  std::optional<Eigen::Vector2d> first_mps;
  for (std::size_t k = 0; k < truth.size(); ++k) {
    const Eigen::Vector2d v_mps = truth[k].segment<2>(2);
    if (!v_mps.allFinite()) continue;
    if (!first_mps) first_mps = v_mps;
    if ((v_mps - *first_mps).norm() > kTolerance_mps) return k;
  }
  return truth.size();
}

// The standard deviation of a component of z: the measurement's own, else the fallback.
double sigma_of(const Measurement& measurement, Eigen::Index component, const std::optional<double>& fallback,
                const char* key) {
  if (measurement.sigma.size() > 0) return measurement.sigma[component];
  if (!fallback) throw InputError(kBound, "measurements carry no standard deviation", std::string("a key ") + key);
  return *fallback;
}

// The frequencies of a source that were heard so far, each once, as they follow the state in the information.
class Levels {
 public:
  /// Place of a frequency, -1 where it was not heard yet.
  Eigen::Index find(double frequency_hz) const {
    constexpr double kSame_hz = 1e-6;
    for (std::size_t i = 0; i < heard_hz_.size(); ++i)
      if (std::abs(heard_hz_[i] - frequency_hz) < kSame_hz) return static_cast<Eigen::Index>(i);
    return -1;
  }
  void add(double frequency_hz) { heard_hz_.push_back(frequency_hz); }

 private:
  std::vector<double> heard_hz_;
};

// What the prior believes at the first bearing, had its guess been right: the covariance at the true state.
Eigen::Matrix4d prior_covariance(const RangePrior& prior, const Measurement& measurement, const Eigen::Vector4d& truth,
                                 const Bearing<>& model) {
  TargetGuess guess = measurement.guess.value_or(TargetGuess{});
  const double speed_sigma_mps = prior.course ? prior.course->speed_sigma_mps : guess.speed_sigma_mps;
  guess.range_m = (truth.head<2>() - model.site_m).norm();
  guess.speed_mps = truth.tail<2>().norm();
  if (!measurement.guess) guess.range_sigma_m = prior.range_sigma_m;
  if (!std::isfinite(guess.speed_sigma_mps)) guess.speed_sigma_mps = speed_sigma_mps;
  const Eigen::Matrix4d P = prior.state(model.h(truth)(0), model.sigma_rad, *measurement.sensor, guess).P;
  if (!P.allFinite()) throw InputError(kBound + std::string(".prior"), "has no range or speed where no guess comes in");
  return P;
}

}  // namespace

std::vector<TargetMotionVariance> TargetMotionBound::variances(const Recording& recording,
                                                               const std::vector<int>& steps) const {
  check_measured(*this, recording);
  if (is_of_radar(recording)) return variances_of_radar(recording, steps);
  const ConstantVelocity<2, ContinuousWhiteNoise> motion{{q_m2ps3}};
  const bool with_frequencies = uses_frequencies(*this, recording);
  const std::vector<BoundedVector>& truth = recording.truth.front().x;
  const std::size_t end = q_m2ps3 > 0.0 ? truth.size() : steady_steps(truth);
  PosteriorInformation<Eigen::Dynamic> information(4);  // about the state, and then about the levels
  Levels levels;
  std::vector<TargetMotionVariance> variances(steps.size());
  bool begun = false;
  double time_s = 0.0;
  for (std::size_t k = 0; k < end; ++k) {
    const Measurement& measurement = recording.measurements[k];
    const Eigen::Vector4d x = truth[k].head<4>();
    const double frequency_hz = with_frequencies ? truth[k][kFrequencyRow] : 0.0;
    if (begun && measurement.time_s > time_s) {
      const double dt_s = measurement.time_s - time_s;
      const Eigen::Index n = information.J().rows();
      Eigen::MatrixXd F = Eigen::MatrixXd::Identity(n, n), Q = Eigen::MatrixXd::Zero(n, n);
      F.topLeftCorner<4, 4>() = motion.F(dt_s);
      Q.topLeftCorner<4, 4>() = motion.Q(dt_s);
      information.predict(F, Q);
    }
    time_s = measurement.time_s;
    const bool known = measurement.z.size() > 0 && x.allFinite();
    const bool seen = known && std::isfinite(measurement.z[0]);
    const bool heard = known && with_frequencies && std::isfinite(measurement.z[1]) && std::isfinite(frequency_hz);
    // With a prior all begins with the bearing that it is about.
    if (seen || (heard && (begun || !prior))) {
      if (!measurement.sensor) throw InputError(kBound, "needs own ship's position with every bearing");
      const SensorState& own_ship = *measurement.sensor;
      BearingFrequency<> model{own_ship.position_m, own_ship.velocity_mps, 1.0, 1.0, sound_mps, seen, heard};
      if (seen) model.sigma_rad = sigma_of(measurement, 0, bearing_sigma_rad, "bearing_sigma_deg");
      if (heard) model.sigma_hz = sigma_of(measurement, 1, frequency_sigma_hz, "frequency_sigma_hz");
      if (!begun && prior) {
        information.add_prior(
            prior_covariance(*prior, measurement, x, {model.site_m, model.site_velocity_mps, model.sigma_rad}));
        model.has_bearing = false;  // the prior has it in it
      }
      if (heard && levels.find(frequency_hz) < 0) {
        levels.add(frequency_hz);
        information.add_parameter();
      }
      Eigen::Matrix<double, 5, Eigen::Dynamic> Phi(5, information.J().cols());
      Phi.setIdentity();
      Phi.row(kFrequencyRow).setZero();
      if (heard) Phi(kFrequencyRow, 4 + levels.find(frequency_hz)) = 1.0;
      Eigen::Matrix<double, 5, 1> state;
      state << x, frequency_hz;
      information.update(model, state, Phi);
      begun = true;
    }
    for (std::size_t i = 0; i < steps.size(); ++i) {
      if (steps[i] != static_cast<int>(k) || !measurement.sensor) continue;
      const std::optional<Eigen::MatrixXd> P = information.covariance();
      if (!P) continue;
      variances[i] = target_motion_variance(x, P->topLeftCorner<4, 4>(), *measurement.sensor);
      if (const Eigen::Index level = levels.find(frequency_hz); level >= 0)
        variances[i].frequency_hz2 = (*P)(4 + level, 4 + level);
    }
  }
  return variances;
}

std::vector<TargetMotionVariance> TargetMotionBound::variances_of_radar(const Recording& recording,
                                                                        const std::vector<int>& steps) const {
  if (prior) throw InputError(kBound + std::string(".prior"), "is of a range, which is measured here");
  const ConstantVelocity<2, ContinuousWhiteNoise> motion{{q_m2ps3}};
  const std::vector<BoundedVector>& truth = recording.truth.front().x;
  const std::size_t end = q_m2ps3 > 0.0 ? truth.size() : steady_steps(truth);
  const bool with_rates = range_rates && recording.measured.size() == 3;
  PosteriorInformation<4> information;
  std::vector<TargetMotionVariance> variances(steps.size());
  double time_s = 0.0;
  for (std::size_t k = 0; k < end; ++k) {
    const Measurement& measurement = recording.measurements[k];
    const Eigen::Vector4d x = truth[k].head<4>();
    if (k > 0) information.predict(motion.F(measurement.time_s - time_s), motion.Q(measurement.time_s - time_s));
    time_s = measurement.time_s;
    const SensorState radar = measurement.sensor.value_or(SensorState{});
    if (!measurement.is_missing() && x.allFinite()) {
      const double sigma_range_m = sigma_of(measurement, 0, range_sigma_m, "range_sigma_m");
      const double sigma_rad = sigma_of(measurement, 1, bearing_sigma_rad, "bearing_sigma_deg");
      if (with_rates)
        information.update(RangeBearingRate<>{radar.position_m, radar.velocity_mps, sigma_range_m, sigma_rad,
                                              sigma_of(measurement, 2, range_rate_sigma_mps, "range_rate_sigma_mps"),
                                              range_rate_correlation},
                           x);
      else
        information.update(RangeBearing<>{radar.position_m, sigma_range_m, sigma_rad}, x);
    }
    for (std::size_t i = 0; i < steps.size(); ++i)
      if (steps[i] == static_cast<int>(k))
        if (const std::optional<Eigen::Matrix4d> P = information.covariance())
          variances[i] = target_motion_variance(x, *P, radar);
  }
  return variances;
}

}  // namespace truebearing
