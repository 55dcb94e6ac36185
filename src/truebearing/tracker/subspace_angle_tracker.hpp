// SPDX-License-Identifier: Apache-2.0
// Several targets' angles from the signal subspace, without data association (Ryu, Lee and Lee 2001, section III.2):
// one Kalman filter per target on [angle, rate], whose innovation is the angle by which its predicted steering vector
// has to turn to lie in the subspace. The first two usable intervals begin the filters (step 1), by a spectrum's angles
// in ascending order.
//
// Beside the paper's own choices stand others: the subspace may be that of the last interval alone, the innovation may
// be that of the angle some time ago, and its variance may follow from the subspace and grow where targets meet.
#pragma once

#include <memory>
#include <optional>
#include <variant>
#include <vector>

#include "truebearing/array/angular_innovation.hpp"
#include "truebearing/array/implicit_innovations.hpp"
#include "truebearing/array/interval.hpp"
#include "truebearing/array/orthogonal_iteration.hpp"
#include "truebearing/array/projection_approximation.hpp"
#include "truebearing/array/sample_covariance.hpp"
#include "truebearing/filter/kalman.hpp"
#include "truebearing/motion/constant_velocity.hpp"
#include "truebearing/tracker/angle_records.hpp"
#include "truebearing/tracker/stream_guard.hpp"
#include "truebearing/tracker/tracker.hpp"

namespace truebearing {

struct SubspaceAngleOptions {
  enum class Subspace {
    projection_approximation,  ///< the paper's: PAST
    orthogonal_iteration,      ///< one iteration on each interval
    eigenvectors               ///< of each interval's covariance; allocates
  };
  enum class Innovation { ryu, projection, implicit };

  std::variant<int, OrderCriterion> targets = 1;
  Subspace subspace = Subspace::projection_approximation;
  Innovation innovation = Innovation::implicit;
  double beta = 0.95;      ///< forgetting factor of PAST, per snapshot
  double q_rad2ps3 = 0.0;  ///< spectral density of the angular acceleration
  double sigma_rad = 0.0;  ///< of the angle that the subspace tells
  /// What the subspace tells is the angle so many intervals before the end of the last: h(x) = angle - lag T rate.
  double lag_intervals = 0.0;
  /// To sigma^2 is added the variance of MUSIC's angles, (1 + 1 / (M snr)) / (2 Ns snr |P_perp b|^2), with the signal
  /// to noise ratio that the least of the signals' eigenvalues has.
  bool sigma_from_subspace = false;
  /// The variance grows as 1 + (s / d)^2 while another target is predicted at a distance d < s. 0: not.
  double inflate_within_rad = 0.0;
};

class SubspaceAngleTracker final : public Tracker {
 public:
  explicit SubspaceAngleTracker(SubspaceAngleOptions options);

  std::span<const StepRecord> step(const Measurement& measurement) override;
  void reset() override;
  std::unique_ptr<Tracker> fresh() const override { return std::make_unique<SubspaceAngleTracker>(options_); }
  const StateSpace& space() const override { return angle_space(); }
  std::optional<Measured> measures() const override { return Measured::snapshots(fewest_sensors(options_.targets)); }
  RecordBlocks blocks() const override {
    return {.prediction = true, .innovation = true, .gain = true, .neighbour = true};
  }
  TrackerCounts counts() const override { return guard_.counts; }

 private:
  using Filter = KalmanFilter<2>;
  using Motion = ConstantVelocity<1, ContinuousWhiteNoise>;
  struct Start {
    double time_s;
    std::vector<double> angles;
  };

  void forget();
  bool is_lost(double dt_s) const;
  Motion motion() const;
  bool begin(double time_s);
  void follow_subspace();
  const SplitMatrix<double>& basis() const;
  void find_innovations(const LineArray& array, double lag_s);
  double variance(std::size_t n, double curvature) const;
  std::span<const StepRecord> publish(const Measurement& measurement, double dt_s, bool usable);

  SubspaceAngleOptions options_;
  StreamGuard guard_;
  Interval interval_;
  std::optional<Start> first_;
  std::vector<Filter> filters_;
  std::vector<Filter> known_;  // the last of them that was inside the sector
  int first_track_ = 0;        // its number
  std::vector<Filter> predicted_;
  double used_time_s_ = 0.0;

  ProjectionApproximation past_;
  OrthogonalIteration orthogonal_;
  SplitMatrix<double> eigenvectors_;
  Eigen::MatrixXcd covariance_;
  double signal_power_ = 1.0, noise_power_ = 1.0;  // means along the basis and off it
  RyuInnovation<double> ryu_;
  ProjectionInnovation<double> projection_;
  ImplicitInnovations implicit_;
  SplitMatrix<double> a_, b_;  // steering vectors at the predicted angles, and their derivatives; not for implicit_
  struct Found {
    AngularInnovation<double> innovation;
    double b2;  // |b|^2
  };
  std::vector<double> expected_rad_;  // of each target the angle that the subspace should tell
  std::vector<Found> found_;
  std::vector<StepRecord> records_;
};

}  // namespace truebearing
