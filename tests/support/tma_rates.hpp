// SPDX-License-Identifier: Apache-2.0
// How often target-motion analysis is right about many simulated logs: manoeuvres and jumps of the tone that were none,
// outliers that were found, turns that were found and when.
#pragma once

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "tests/support/tma_bounds.hpp"
#include "truebearing/core/angle.hpp"
#include "truebearing/core/random.hpp"
#include "truebearing/simulation/scenario.hpp"
#include "truebearing/tma/frequency_changes.hpp"
#include "truebearing/tma/residual_checks.hpp"
#include "truebearing/tma/target_motion_batch.hpp"

namespace truebearing::testing {

struct TmaCase {
  std::string method = "ml";   ///< ml, map, huber
  double end_s = 1e9;          ///< of the window
  double outlier_share = 0.0;  ///< of bearings, and of frequencies
  double outlier_sigmas = 10.0;
};

struct TmaRates {
  int logs = 0, manoeuvres = 0, jumps = 0, unfit = 0, coloured = 0, biased = 0;
  int outliers = 0, outliers_found = 0, outliers_invented = 0, logs_with_all_found = 0;
  double outliers_to_find = 0.0;            ///< of those that are there, expected at best (tma_bounds.hpp)
  std::vector<double> change_s;             ///< of the manoeuvres
  std::set<std::uint64_t> with_manoeuvres;  ///< numbers of the logs that had one, in whichever window
  std::set<std::uint64_t> with_jumps;

  TmaRates& operator+=(const TmaRates& more) {
    logs += more.logs;
    manoeuvres += more.manoeuvres;
    jumps += more.jumps;
    unfit += more.unfit;
    coloured += more.coloured;
    biased += more.biased;
    outliers += more.outliers;
    outliers_found += more.outliers_found;
    outliers_invented += more.outliers_invented;
    logs_with_all_found += more.logs_with_all_found;
    outliers_to_find += more.outliers_to_find;
    change_s.insert(change_s.end(), more.change_s.begin(), more.change_s.end());
    with_manoeuvres.insert(more.with_manoeuvres.begin(), more.with_manoeuvres.end());
    with_jumps.insert(more.with_jumps.begin(), more.with_jumps.end());
    return *this;
  }
};

/// One log as TMA sees it, with its outliers.
class TmaLog {
 public:
  TmaLog(const Recording& recording, const TmaCase& what, std::uint64_t run) : run_(run) {
    truth_.time_s = recording.measurements.front().time_s;
    truth_.x = recording.truth[0].x.front().head<4>();
    RandomStream stream({what.outlier_share > 0.0 ? 99u : 98u, Role::evaluation, run}, StreamId::test);
    for (const Measurement& m : recording.measurements) {
      if (m.time_s > what.end_s) break;
      const auto outlier = [&] {
        const bool is_one = stream.uniform() < what.outlier_share;
        const double side = stream.uniform() < 0.5 ? -1.0 : 1.0;
        return is_one ? side * what.outlier_sigmas : 0.0;
      };
      if (std::isfinite(m.z[0])) {
        const double off = outlier();
        if (off != 0.0) outliers_.push_back(bearings_.size());
        bearings_.add(m.time_s, m.z[0] + off * m.sigma[0], m.sigma[0], m.sensor->position_m);
      }
      if (m.z.size() == 2 && std::isfinite(m.z[1]))
        frequencies_.add(m.time_s, m.z[1] + outlier() * m.sigma[1], m.sigma[1], *m.sensor);
    }
  }

  void examine(const TmaCase& what, TmaRates& rates) {
    TargetMotionBatch batch({.huber_sigmas = what.method == "huber" ? 2.0 : std::numeric_limits<double>::infinity()});
    std::optional<BatchPrior> prior;
    if (what.method == "map") prior.emplace().velocity_information = Eigen::Matrix2d::Identity() / 25.0;
    FrequencyChangeBatch changes(FrequencyChangeOptions::of_a_log());
    DopplerWindow* heard = frequencies_.size() > 0 ? &frequencies_ : nullptr;
    const BatchEstimate estimate =
        heard ? changes.solve(batch, bearings_, *heard, prior) : batch.solve(bearings_, prior);
    const ResidualChecks checks = check_residuals(bearings_, estimate, heard);
    ++rates.logs;
    rates.manoeuvres += checks.manoeuvred;
    const bool jumped = heard && !changes.changes().empty();
    rates.jumps += jumped;
    if (checks.manoeuvred) rates.with_manoeuvres.insert(run_);
    if (jumped) rates.with_jumps.insert(run_);
    rates.unfit += !checks.rest.fits();
    rates.coloured += !checks.white;
    rates.biased += checks.bias.detected;
    if (checks.manoeuvred) rates.change_s.push_back(checks.manoeuvre_s);
    int found = 0;
    for (const Outlier& outlier : checks.outliers)
      found += std::find(outliers_.begin(), outliers_.end(), outlier.at) != outliers_.end();
    rates.outliers += static_cast<int>(outliers_.size());
    rates.outliers_found += found;
    rates.outliers_invented += static_cast<int>(checks.outliers.size()) - found;
    rates.outliers_to_find += outliers_to_be_found(bearings_, heard, truth_, outliers_, what.outlier_sigmas);
    rates.logs_with_all_found += found == static_cast<int>(outliers_.size());
  }

 private:
  std::uint64_t run_;
  BatchEstimate truth_;  // at the first measurement
  BearingWindow bearings_;
  DopplerWindow frequencies_;
  std::vector<std::size_t> outliers_;
};

/// A scenario of the project with these turns of the target in place of its own: a row of TOML, or nothing.
inline std::unique_ptr<Scenario> scenario_with_turns(const std::string& name, const std::string& turns) {
  const std::string path =
      (std::filesystem::path(TRUEBEARING_SOURCE_DIR) / "data/scenarios" / (name + ".toml")).string();
  std::ifstream file(path);
  std::string text, line;
  for (bool of_target = false; std::getline(file, line);) {
    if (line.starts_with("[")) of_target = line == "[target]";
    if (!of_target || !line.starts_with("turns")) text += line + "\n";
    if (line == "[target]") text += turns + "\n";
  }
  const SharedTable table = parse_toml(text, path);
  return read_scenario(TableReader(table, path));
}

inline TmaRates rates_of(const Scenario& scenario, const TmaCase& what, int logs, std::uint64_t seed) {
  TmaRates rates;
  for (int run = 0; run < logs; ++run) {
    const auto number = static_cast<std::uint64_t>(run);
    TmaLog(scenario.simulate({seed, Role::evaluation, number}), what, number).examine(what, rates);
  }
  return rates;
}

struct TurnRates {
  int found = 0, dated = 0;  ///< of the logs; of those that were found
  double change_mps = 0.0;
  ChangeBound bound{};
};
/// Of a target that turns once, about middle_s, in whole logs.
inline TurnRates turn_rates_of(const Scenario& scenario, double middle_s, double within_s, int logs,
                               std::uint64_t seed) {
  TurnRates turns;
  const Recording one = scenario.simulate({seed, Role::evaluation, 0});
  BearingWindow bearings;
  DopplerWindow frequencies;
  for (const Measurement& m : one.measurements) {
    if (std::isfinite(m.z[0])) bearings.add(m.time_s, m.z[0], m.sigma[0], m.sensor->position_m);
    if (m.z.size() == 2 && std::isfinite(m.z[1])) frequencies.add(m.time_s, m.z[1], m.sigma[1], *m.sensor);
  }
  BatchEstimate before;
  before.time_s = one.measurements.front().time_s;
  before.x = one.truth[0].x.front().head<4>();
  const Eigen::Vector2d change_mps = one.truth[0].x.back().segment<2>(2) - before.x.tail<2>();
  turns.change_mps = change_mps.norm();
  const DopplerWindow* heard = frequencies.size() > 0 ? &frequencies : nullptr;
  turns.bound = change_bound(bearings, heard, before, change_mps, middle_s,
                             VelocityChangeScan(bearings, heard, before).threshold(1e-3));
  const TmaRates rates = rates_of(scenario, {}, logs, seed);
  turns.found = rates.manoeuvres;
  for (const double change_s : rates.change_s) turns.dated += std::abs(change_s - middle_s) <= within_s;
  return turns;
}

}  // namespace truebearing::testing
