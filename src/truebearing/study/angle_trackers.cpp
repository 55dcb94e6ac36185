// SPDX-License-Identifier: Apache-2.0
#include "truebearing/study/angle_trackers.hpp"

#include <toml++/toml.h>

#include "truebearing/core/angle.hpp"
#include "truebearing/tracker/joint_angle_tracker.hpp"
#include "truebearing/tracker/subspace_angle_tracker.hpp"

namespace truebearing {
namespace {

constexpr double kSquareDegree = radians(1.0) * radians(1.0);

std::variant<int, OrderCriterion> read_targets(TableReader& table, int least, int most) {
  const toml::node* node = table.node("targets");
  if (!node || !node->is_string()) return static_cast<int>(table.integer("targets", least, most));
  if (table.choice("targets", {"mdl", "aic"}) == "aic") return OrderCriterion::akaike;
  return OrderCriterion::minimum_description_length;
}

JointAngleMotion read_motion(TableReader table) {
  JointAngleMotion motion;
  motion.q0 = table.number("q_deg2ps3", kPositive) * kSquareDegree;
  motion.q_low = motion.q_high = motion.q0;
  if (table.has("q_low_deg2ps3") || table.has("q_high_deg2ps3")) {
    motion.q_low = table.number("q_low_deg2ps3", kPositive) * kSquareDegree;
    motion.q_high = table.number("q_high_deg2ps3", kPositive) * kSquareDegree;
    if (motion.q_low > motion.q_high) throw table.error("q_low_deg2ps3", "is above q_high_deg2ps3", "less");
  }
  motion.alpha = table.number_or("innovation_alpha", motion.alpha, {0.0, 1.0, true});
  motion.close_q_low = motion.q_low;
  motion.close_q_high = motion.q_high;
  if (table.has("close_deg")) {
    motion.close_rad = radians(table.number("close_deg", {0.0, 90.0, true}));
    motion.close_q_low = table.number("close_q_low_deg2ps3", kPositive) * kSquareDegree;
    motion.close_q_high = table.number("close_q_high_deg2ps3", kPositive) * kSquareDegree;
    if (motion.close_q_low > motion.close_q_high)
      throw table.error("close_q_low_deg2ps3", "is above close_q_high_deg2ps3", "less");
  }
  motion.log_power_variance_per_s = table.number_or("log_power_variance_per_s", 1e-3, kNonNegative);
  table.finish();
  return motion;
}

JointAngleOptions::Lifetimes read_lifetimes(TableReader table) {
  JointAngleOptions::Lifetimes lifetimes;
  lifetimes.begin_presence = table.number_or("begin_presence", lifetimes.begin_presence, kPositive);
  lifetimes.begin_hits = static_cast<int>(table.integer_or("begin_hits", lifetimes.begin_hits, 1, 3));
  lifetimes.end_presence = table.number_or("end_presence", lifetimes.end_presence, kNonNegative);
  lifetimes.end_misses = static_cast<int>(table.integer_or("end_misses", lifetimes.end_misses, 1, 1000));
  lifetimes.close_misses = static_cast<int>(table.integer_or("close_misses", lifetimes.close_misses, 0, 1000));
  table.finish();
  return lifetimes;
}

}  // namespace

std::unique_ptr<Tracker> make_subspace_angles(TableReader& table) {
  constexpr int kMostTargets = 64;
  SubspaceAngleOptions options;
  options.targets = read_targets(table, 1, kMostTargets);
  const std::string subspace = table.choice_or("subspace", {"past", "orthogonal_iteration", "eigenvectors"}, "past");
  if (subspace == "orthogonal_iteration") options.subspace = SubspaceAngleOptions::Subspace::orthogonal_iteration;
  if (subspace == "eigenvectors") options.subspace = SubspaceAngleOptions::Subspace::eigenvectors;
  if (subspace == "past") options.beta = table.number_or("beta", options.beta, {0.0, 1.0, true});
  const std::string innovation = table.choice_or("innovation", {"implicit", "projection", "ryu"}, "implicit");
  if (innovation == "projection") options.innovation = SubspaceAngleOptions::Innovation::projection;
  if (innovation == "ryu") options.innovation = SubspaceAngleOptions::Innovation::ryu;
  options.q_rad2ps3 = table.number("q_deg2ps3", kPositive) * kSquareDegree;
  options.sigma_rad = radians(table.number("sigma_deg", kPositive));
  options.lag_intervals = table.number_or("lag_intervals", 0.0, {0.0, 10.0});
  options.sigma_from_subspace = table.boolean_or("sigma_from_subspace", false);
  options.inflate_within_rad = radians(table.number_or("inflate_within_deg", 0.0, {0.0, 90.0}));
  return std::make_unique<SubspaceAngleTracker>(options);
}

std::unique_ptr<Tracker> make_joint_angles(TableReader& table) {
  JointAngleOptions options;
  if (table.has("lifetimes")) options.lifetimes = read_lifetimes(table.table("lifetimes"));
  options.targets = read_targets(table, options.lifetimes ? 0 : 1, kMaxSignals);
  options.hypotheses.motion = read_motion(table.table("motion"));
  options.hypotheses.update.iterations = static_cast<int>(table.integer_or("iterations", 5, 2, 100));
  options.hypotheses.beam = static_cast<int>(table.integer_or("beam", options.hypotheses.beam, 1, 64));
  options.rate_sigma_radps = radians(table.number("rate_sigma_degps", kPositive));
  options.moving_blocks = static_cast<int>(table.integer_or("moving_blocks", 0, 0, 100));
  if (table.has("noise_power")) options.noise_power = table.number("noise_power", kPositive);
  options.noise_alpha = table.number_or("noise_alpha", options.noise_alpha, {0.0, 1.0, true});
  return std::make_unique<JointAngleTracker>(std::move(options));
}

}  // namespace truebearing
