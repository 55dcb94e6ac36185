// SPDX-License-Identifier: Apache-2.0
#include "truebearing/tma/cho_2015.hpp"

#include <Eigen/LU>
#include <array>
#include <cmath>

#include "truebearing/tma/cho_pack.hpp"

namespace truebearing {
namespace {

Eigen::Vector4d gauss_newton_step(const NormalEquations<4>& at, ChoOptions::Inverse inverse) {
  switch (inverse) {
    case ChoOptions::Inverse::cofactor:
      return at.A.inverse() * at.gradient;
    case ChoOptions::Inverse::cofactor_float:
      return (at.A.cast<float>().inverse() * at.gradient.cast<float>()).cast<double>();
    case ChoOptions::Inverse::pivoted:
      break;
  }
  return at.A.fullPivLu().solve(at.gradient);
}

// The descents from all starts, kPack of them at a time: where one ends, the next start takes its lane.
class Descents {
 public:
  Descents(const BearingWindow& window, const ChoOptions& options) : window_(window), options_(options) {}

  /// The best of all, at the time of the first bearing; P there is the information.
  BatchEstimate run() {
    const bool damped = options_.method != ChoOptions::Method::gauss_newton;
    for (Lane& lane : lanes_) begin(lane);
    while (active_ > 0) {
      sum_pack(window_.arrays(), window_.first_time_s(), pack_);
      for (Lane& lane : lanes_) look_at(lane);
      if (damped)  // Equation (10)
        damped_steps(options_.method == ChoOptions::Method::levenberg_marquardt, pack_);
      else  // Equation (9)
        for (const Lane& lane : lanes_) set_step(lane, gauss_newton_step(equations(lane), options_.inverse));
      for (Lane& lane : lanes_) step(lane);
    }
    return best_;
  }

 private:
  struct Lane {
    int place = 0;        // in the pack
    int start = -1;       // of kChoStarts; -1 where no start is left
    int iterations = -1;  // -1 before the first look
    double cost = 0.0;    // before the last step
  };

  void begin(Lane& lane) {
    active_ -= lane.start >= 0 ? 1 : 0;
    lane.place = static_cast<int>(&lane - lanes_.data());
    lane.start = next_ < kChoStarts ? next_++ : -1;
    lane.iterations = -1;
    if (lane.start < 0) return;
    ++active_;
    const Eigen::Vector4d x = cho_start(window_, lane.start);
    for (int i = 0; i < 4; ++i) pack_.x[i][lane.place] = x[i];
  }

  // At x, where its last step has led: sets its damping, or ends it.
  void look_at(Lane& lane) {
    if (lane.start < 0) return;
    const int k = lane.place;
    const double cost = pack_.sums[kCost][k];
    double& mu = pack_.mu[k];
    double squared = 0.0;
    if (++lane.iterations == 0) {
      mu = equations(lane).A.maxCoeff();
    } else {
      const double ratio = (lane.cost - cost) / pack_.promised[k];  // Equation (11)
      if (ratio < 0.25)                                             // Equation (12)
        mu *= 2.0;
      else if (ratio > 0.75)
        mu /= 3.0;
      for (int i = 0; i < 4; ++i) squared += pack_.h[i][k] * pack_.h[i][k];
    }
    lane.cost = cost;
    double any = 0.0;  // stays zero while all are finite
    for (const auto& row : pack_.sums) any += 0.0 * row[k];
    const bool converged = lane.iterations > 0 && squared < options_.tolerance * options_.tolerance;
    if (!converged && lane.iterations < options_.k_max && any == 0.0) return;
    conclude(lane, converged, any == 0.0);
    begin(lane);
  }

  void step(const Lane& lane) {
    if (lane.start < 0 || lane.iterations < 0) return;
    for (int i = 0; i < 4; ++i) pack_.x[i][lane.place] += pack_.h[i][lane.place];
  }

  void conclude(const Lane& lane, bool converged, bool finite) {
    const Eigen::Vector4d x = column(pack_.x, lane.place);
    ++best_.starts;
    if (!finite || !x.allFinite()) {
      ++best_.non_finite_starts;
      return;
    }
    // Of equals the first start, whichever of them ended first.
    if (best_.found && (lane.cost > best_.cost || (lane.cost == best_.cost && lane.start > best_start_))) return;
    best_start_ = lane.start;
    best_.found = true;
    best_.cost = lane.cost;
    best_.iterations = lane.iterations;
    best_.converged = converged;
    best_.x = x;
    best_.P = equations(lane).A;
  }

  static Eigen::Vector4d column(const double (&rows)[4][kPack], int k) {
    return {rows[0][k], rows[1][k], rows[2][k], rows[3][k]};
  }
  void set_step(const Lane& lane, const Eigen::Vector4d& h) {
    for (int i = 0; i < 4; ++i) pack_.h[i][lane.place] = h[i];
  }

  NormalEquations<4> equations(const Lane& lane) const {
    const int k = lane.place;
    NormalEquations<4> at;
    at.cost = pack_.sums[kCost][k];
    for (int i = 0; i < 4; ++i) {
      at.gradient[i] = pack_.sums[kRa + i][k];
      for (int j = 0; j < 4; ++j) at.A(i, j) = pack_.sums[kNormalMatrix[i][j]][k];
    }
    return at;
  }

  const BearingWindow& window_;
  const ChoOptions& options_;
  ChoPack pack_{};
  std::array<Lane, kPack> lanes_;
  int next_ = 0, active_ = 0, best_start_ = 0;
  BatchEstimate best_;
};

}  // namespace

Eigen::Vector4d cho_start(const BearingWindow& window, int i) {
  constexpr double kKilometre = 1000.0;
  const auto position = [&](std::size_t k, int kilometres) -> Eigen::Vector2d {
    const double bearing = window.bearing_rad(k);
    return window.site_m(k) + kilometres * kKilometre * Eigen::Vector2d(std::sin(bearing), std::cos(bearing));
  };
  const Eigen::Vector2d first = position(0, 1 + i / kChoRanges);
  const Eigen::Vector2d last = position(window.size() - 1, 1 + i % kChoRanges);
  Eigen::Vector4d x;
  x << first, (last - first) / (window.last_time_s() - window.first_time_s());
  return x;
}

BatchEstimate solve_cho(const BearingWindow& window, const ChoOptions& options) {
  BatchEstimate estimate = Descents(window, options).run();
  estimate.time_s = window.last_time_s();
  if (!estimate.found) return estimate;
  estimate.P = covariance_of(estimate.P);
  carry(window.last_time_s() - window.first_time_s(), estimate.x, estimate.P);
  return estimate;
}

}  // namespace truebearing
