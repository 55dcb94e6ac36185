// SPDX-License-Identifier: Apache-2.0
#include "truebearing/simulation/scenario.hpp"

#include <array>
#include <string>
#include <utility>
#include <vector>

#include "truebearing/simulation/bearings_only_scenario.hpp"
#include "truebearing/simulation/line_array_scenario.hpp"
#include "truebearing/simulation/line_scenario.hpp"
#include "truebearing/simulation/lorenz_scenario.hpp"
#include "truebearing/simulation/planar_flight_scenario.hpp"
#include "truebearing/simulation/planar_legs_scenario.hpp"
#include "truebearing/simulation/space_flight_scenario.hpp"

namespace truebearing {
namespace {

struct ScenarioKind {
  const char* name;
  std::unique_ptr<Scenario> (*read)(TableReader&);
};
constexpr std::array kKinds{ScenarioKind{"line", read_line_scenario},
                            ScenarioKind{"planar_flight", read_planar_flight_scenario},
                            ScenarioKind{"planar_legs", read_planar_legs_scenario},
                            ScenarioKind{"space_flight", read_space_flight_scenario},
                            ScenarioKind{"bearings_only", read_bearings_only_scenario},
                            ScenarioKind{"passive_sonar", read_passive_sonar_scenario},
                            ScenarioKind{"line_array", read_line_array_scenario},
                            ScenarioKind{"lorenz", read_lorenz_scenario}};

}  // namespace

std::unique_ptr<Scenario> read_scenario(TableReader table, const ScenarioKinds& more) {
  std::vector<std::string> names;
  for (const ScenarioKind& kind : kKinds) names.emplace_back(kind.name);
  for (const auto& [name, read] : more) names.push_back(name);
  const std::string name = table.choice("kind", names);
  std::unique_ptr<Scenario> scenario;
  for (const ScenarioKind& kind : kKinds)
    if (kind.name == name) scenario = kind.read(table);
  if (const auto found = more.find(name); found != more.end()) scenario = found->second(table);
  table.finish();
  return scenario;
}

std::unique_ptr<Scenario> load_scenario(const std::filesystem::path& path, const ScenarioKinds& more) {
  return read_scenario(TableReader(read_toml_file(path), path.string()), more);
}

}  // namespace truebearing
