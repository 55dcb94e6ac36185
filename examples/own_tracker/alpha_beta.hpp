// SPDX-License-Identifier: Apache-2.0
// The alpha-beta filter: a tracker on a line whose gain K = [alpha, beta / dt]' (2 x 1) is chosen, not computed.
//     predict  x = F x,  P = F P F' + Q          update  x = x + K nu,  P = (I - K H) P (I - K H)' + K R K'
// Joseph's form holds for any gain, so P is the covariance that this gain earns. Bar-Shalom, Li and Kirubarajan 2001,
// sections 5.2.3 and 6.5.
#pragma once

#include <memory>
#include <optional>
#include <span>

#include "truebearing/io/table_reader.hpp"
#include "truebearing/motion/constant_velocity.hpp"
#include "truebearing/tracker/stream_guard.hpp"
#include "truebearing/tracker/tracker.hpp"

namespace example {

class AlphaBetaTracker final : public truebearing::Tracker {
 public:
  struct Options {
    double alpha = 0.0;               ///< in (0, 1]
    double beta = 0.0;                ///< in (0, 2)
    double sigma_m = 0.0;             ///< of a measured position
    double sigma_a_mps2 = 0.0;        ///< of the acceleration, which changes from step to step
    double velocity_sigma_mps = 0.0;  ///< of the velocity before the first measurement, about zero
  };

  explicit AlphaBetaTracker(const Options& options);

  std::span<const truebearing::StepRecord> step(const truebearing::Measurement& measurement) override;
  void reset() override;
  std::unique_ptr<truebearing::Tracker> fresh() const override { return std::make_unique<AlphaBetaTracker>(options_); }
  const truebearing::StateSpace& space() const override { return truebearing::line_space(); }
  std::optional<truebearing::Measured> measures() const override { return truebearing::Measured::position(1); }
  truebearing::RecordBlocks blocks() const override { return {.prediction = true, .innovation = true, .gain = true}; }
  truebearing::TrackerCounts counts() const override { return guard_.counts; }

 private:
  void start(double z_m, double R);
  void predict(double dt_s);
  void update(double z_m, double R, double dt_s);

  Options options_;
  truebearing::ConstantVelocity<1, truebearing::DiscreteWhiteNoise> motion_;
  truebearing::StreamGuard guard_;
  Eigen::Vector2d x_;
  Eigen::Matrix2d P_;
  truebearing::StepRecord record_;
};

/// From its table in a study. Throws InputError.
std::unique_ptr<truebearing::Tracker> make_alpha_beta(truebearing::TableReader& table);

}  // namespace example
