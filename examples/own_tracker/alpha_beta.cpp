// SPDX-License-Identifier: Apache-2.0
#include "alpha_beta.hpp"

namespace example {

using namespace truebearing;

AlphaBetaTracker::AlphaBetaTracker(const Options& options)
    : options_(options), motion_{.noise = {.sigma_a = options.sigma_a_mps2}} {
  reset();
}

void AlphaBetaTracker::reset() {
  guard_ = {};
  record_ = {};
  record_.space = &space();
}

std::span<const StepRecord> AlphaBetaTracker::step(const Measurement& measurement) {
  const auto verdict = guard_.examine(measurement);
  const bool usable = verdict == StreamGuard::Verdict::usable && measurement.z.size() == 1;
  const bool started = record_.x.size() > 0;
  if (!started && !usable) return {};

  record_.prediction.reset();
  record_.innovation.reset();
  record_.gain.reset();
  record_.status = StepStatus::rejected;
  if (verdict == StreamGuard::Verdict::repeated || verdict == StreamGuard::Verdict::out_of_order) return {&record_, 1};

  const double dt_s = measurement.time_s - record_.time_s;
  const double sigma_m = measurement.sigma.size() == 1 ? measurement.sigma[0] : options_.sigma_m;
  record_.status = usable ? StepStatus::ok : StepStatus::coasted;
  record_.time_s = measurement.time_s;
  record_.sensor = measurement.sensor;
  if (started) predict(dt_s);
  if (started && usable) update(measurement.z[0], sigma_m * sigma_m, dt_s);
  if (!started) start(measurement.z[0], sigma_m * sigma_m);
  record_.x = x_;
  record_.P = P_;
  return {&record_, 1};
}

void AlphaBetaTracker::start(double z_m, double R) {
  x_ = {z_m, 0.0};
  P_ = Eigen::Vector2d(R, options_.velocity_sigma_mps * options_.velocity_sigma_mps).asDiagonal();
}

void AlphaBetaTracker::predict(double dt_s) {
  const Eigen::Matrix2d F = motion_.F(dt_s);
  x_ = F * x_;
  P_ = F * P_ * F.transpose() + motion_.Q(dt_s);
  record_.prediction = {x_, P_};
}

void AlphaBetaTracker::update(double z_m, double R, double dt_s) {
  // Two measurements of one time say nothing of the velocity.
  const Eigen::Vector2d K(options_.alpha, dt_s > 0.0 ? options_.beta / dt_s : 0.0);
  const double nu = z_m - x_[0];
  const double S = P_(0, 0) + R;
  Eigen::Matrix2d I_KH = Eigen::Matrix2d::Identity();
  I_KH.col(0) -= K;
  x_ += K * nu;
  P_ = I_KH * P_ * I_KH.transpose() + R * K * K.transpose();

  Innovation& innovation = record_.innovation.emplace();
  innovation.z = BoundedVector::Constant(1, z_m);
  innovation.nu = BoundedVector::Constant(1, nu);
  innovation.S = BoundedMatrix::Constant(1, 1, S);
  innovation.nis = nu * nu / S;
  record_.gain = K;
}

std::unique_ptr<Tracker> make_alpha_beta(TableReader& table) {
  AlphaBetaTracker::Options options;
  options.alpha = table.number("alpha", {.low = 0.0, .high = 1.0, .open_low = true});
  options.beta = table.number("beta", {.low = 0.0, .high = 2.0, .open_low = true});
  options.sigma_m = table.number("sigma_m", kPositive);
  options.sigma_a_mps2 = table.number("sigma_a_mps2", kNonNegative);
  options.velocity_sigma_mps = table.number("velocity_sigma_mps", kPositive);
  return std::make_unique<AlphaBetaTracker>(options);
}

}  // namespace example
