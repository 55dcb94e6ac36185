// SPDX-License-Identifier: Apache-2.0
#include "truebearing/study/tracker_registry.hpp"

#include <fmt/format.h>
#include <map>
#include <mutex>
#include <utility>

#include "truebearing/core/error.hpp"
#include "truebearing/core/suggestion.hpp"
#include "truebearing/io/key_survey.hpp"
#include "truebearing/study/angle_trackers.hpp"
#include "truebearing/study/batch_trackers.hpp"
#include "truebearing/study/filter_trackers.hpp"
#include "truebearing/study/limit_trackers.hpp"
#include "truebearing/study/passive_sonar_configuration.hpp"
#include "truebearing/study/unfiltered_trackers.hpp"

namespace truebearing {
namespace {

struct Registry {
  std::mutex mutex;
  std::map<std::string, TrackerMaker> makers{
      {"bearings_batch", make_bearings_batch},
      {"joint_angles", make_joint_angles},
      {"subspace_angles", make_subspace_angles},
      {"kalman", make_kalman_tracker},
      {"kalman_bank", make_kalman_bank},
      {"unscented", make_unscented_tracker},
      {"imm", make_multiple_model_tracker},
      {"raw", make_raw_tracker},
      {"recorded", make_recorded_tracker},
      {"modified_gain", make_modified_gain_tracker},
      {"passive_sonar", make_passive_sonar_tracker},
      {"log_polar", make_log_polar_tracker},
      {"range_bank", make_range_bank},
  };
};

Registry& registry() {
  static Registry the_registry;
  return the_registry;
}

std::unique_ptr<Tracker> make_of_scenario(TableReader& configuration, const Scenario* scenario) {
  if (!scenario)
    throw configuration.error("kind", fmt::format("is \"{}\", which knows a study's scenario", kParticleLimit),
                              "a tracker of a study");
  return make_particle_limit(configuration, *scenario);
}

}  // namespace

void register_tracker(const std::string& kind, TrackerMaker maker) {
  const std::lock_guard lock(registry().mutex);
  if (kind.empty() || kind == "corrected" || kind == kSmoother || kind == kParticleLimit ||
      !registry().makers.emplace(kind, std::move(maker)).second)
    throw InputError("register_tracker", "the kind \"" + kind + "\" is taken", "a new name");
}

std::vector<std::string> tracker_kinds() {
  const std::lock_guard lock(registry().mutex);
  std::vector<std::string> kinds;
  for (const auto& [kind, maker] : registry().makers) kinds.push_back(kind);
  kinds.emplace_back(kParticleLimit);
  return kinds;
}

std::unique_ptr<Tracker> make_tracker(const std::string& kind, TableReader& configuration, const Scenario* scenario) {
  TrackerMaker maker;
  if (kind == kParticleLimit) {
    maker = [scenario](TableReader& table) { return make_of_scenario(table, scenario); };
  } else {
    const std::lock_guard lock(registry().mutex);
    if (const auto found = registry().makers.find(kind); found != registry().makers.end()) maker = found->second;
  }
  if (!maker) {
    std::vector<std::string> valid = tracker_kinds();
    valid.insert(valid.end(), {"corrected", kSmoother});
    throw configuration.error("kind", "is \"" + kind + "\"", suggestion(kind, valid));
  }
  note_kind(configuration, kind);
  std::unique_ptr<Tracker> tracker = maker(configuration);
  configuration.finish();
  return tracker;
}

}  // namespace truebearing
