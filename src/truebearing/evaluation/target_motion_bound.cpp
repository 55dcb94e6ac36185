#include "truebearing/evaluation/target_motion_bound.hpp"

#include <cmath>
#include <fmt/format.h>
#include <string>

#include "truebearing/core/error.hpp"
#include "truebearing/measurement/posterior_information.hpp"
#include "truebearing/measurement/bearing.hpp"
#include "truebearing/motion/constant_velocity.hpp"

namespace truebearing {
namespace {

constexpr const char* kWhere = "scoring.bound";

void check(const Recording& recording, double q_m2ps3) {
  if (recording.measured != std::vector<std::string>{"bearing_deg"})
    throw InputError(kWhere, fmt::format("cannot be made for {}", fmt::join(recording.measured, ", ")), "bearing_deg");
  if (recording.truth_space != &plane_space() || recording.truth.size() != 1)
    throw InputError(kWhere, "needs the truth of one target in the plane");
  if (q_m2ps3 > 0.0) return;
  constexpr double kTolerance_mps = 1e-3;
  const std::vector<BoundedVector>& truth = recording.truth.front().x;
  for (std::size_t k = 0; k < truth.size(); ++k)
    if (!((truth[k].tail<2>() - truth.front().tail<2>()).norm() <= kTolerance_mps))
      throw InputError(kWhere,
                       fmt::format("holds for a constant velocity, but the truth's changes by {:.6g} s",
                                   recording.measurements[k].time_s),
                       "targets that do not manoeuvre, or a process noise q_m2ps3 > 0");
}

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
  if (!P.allFinite()) throw InputError(kWhere + std::string(".prior"), "has no range or speed where no guess comes in");
  return P;
}

}  // namespace

std::vector<TargetMotionVariance> TargetMotionBound::variances(const Recording& recording,
                                                               const std::vector<int>& steps) const {
  check(recording, q_m2ps3);
  const ConstantVelocity<2, ContinuousWhiteNoise> motion{{q_m2ps3}};
  PosteriorInformation<4> information;
  std::vector<TargetMotionVariance> variances(steps.size());
  bool begun = false;
  double time_s = 0.0;
  for (std::size_t k = 0; k < recording.measurements.size(); ++k) {
    const Measurement& measurement = recording.measurements[k];
    const Eigen::Vector4d x = recording.truth.front().x[k];
    if (begun && measurement.time_s > time_s) {
      const double dt_s = measurement.time_s - time_s;
      information.predict(motion.F(dt_s), motion.Q(dt_s));
    }
    time_s = measurement.time_s;
    if (!measurement.is_missing() && x.allFinite()) {
      if (!measurement.sensor) throw InputError(kWhere, "needs own ship's position with every bearing");
      if (measurement.sigma.size() == 0 && !bearing_sigma_rad)
        throw InputError(kWhere, "measurements carry no standard deviation", "a key bearing_sigma_deg");
      const double sigma_rad = measurement.sigma.size() > 0 ? measurement.sigma[0] : *bearing_sigma_rad;
      const SensorState& own_ship = *measurement.sensor;
      const Bearing<> model{own_ship.position_m, own_ship.velocity_mps, sigma_rad};
      // A prior has the first bearing in it.
      if (!begun && prior)
        information.add_prior(prior_covariance(*prior, measurement, x, model));
      else
        information.update(model, x);
      begun = true;
    }
    for (std::size_t i = 0; i < steps.size(); ++i)
      if (steps[i] == static_cast<int>(k) && measurement.sensor)
        if (const auto P = information.covariance()) variances[i] = target_motion_variance(x, *P, *measurement.sensor);
  }
  return variances;
}

}  // namespace truebearing
