// SPDX-License-Identifier: Apache-2.0
// A scenario: what happens. simulate() makes the truth and the measurements of one run, a pure function of (scenario,
// role, seed, run). A scenario with distributions in it is a family: each run draws from them.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "truebearing/core/random.hpp"
#include "truebearing/core/state_space.hpp"
#include "truebearing/io/table_reader.hpp"
#include "truebearing/measurement/measured.hpp"
#include "truebearing/recording/recording.hpp"

namespace truebearing {

class Scenario {
 public:
  virtual ~Scenario() = default;
  /// Truth and measurements of one run. Safe to call from several threads at once.
  virtual Recording simulate(const RunKey& key) const = 0;
  /// The space of the truth of every run.
  virtual const StateSpace& truth_space() const = 0;
  /// What the measurements of every run are; nothing where it does not say.
  virtual std::optional<Measured> measured() const { return std::nullopt; }
  /// Whether it is a sensor that reports its standard deviations with every measurement.
  virtual bool reports_sigma() const { return false; }
  /// So many runs of a role differ, as where logs are replayed: run k is run k mod that again. Nothing where each is
  /// drawn anew.
  virtual std::optional<std::size_t> different_runs(Role) const { return std::nullopt; }
  /// What whoever reads its results should know of it, as a line; mostly nothing.
  virtual std::string note() const { return {}; }

 protected:
  Scenario() = default;
  Scenario(const Scenario&) = default;
  Scenario& operator=(const Scenario&) = default;
};

/// Reads a scenario table; its key `kind` names which: "line", "planar_flight", "planar_legs",
/// "space_flight", "bearings_only", "passive_sonar", "line_array" or "lorenz". Throws InputError.
/// `more` holds the kinds that a room further on adds, by name.
using ScenarioReader = std::function<std::unique_ptr<Scenario>(TableReader&)>;
using ScenarioKinds = std::map<std::string, ScenarioReader>;
std::unique_ptr<Scenario> read_scenario(TableReader table, const ScenarioKinds& more = {});
std::unique_ptr<Scenario> load_scenario(const std::filesystem::path& path, const ScenarioKinds& more = {});

}  // namespace truebearing
