// SPDX-License-Identifier: Apache-2.0
#include "app/track_scores.hpp"

#include <fmt/format.h>
#include <optional>
#include <type_traits>

#include "app/output.hpp"
#include "truebearing/core/error.hpp"
#include "truebearing/evaluation/time_steps.hpp"
#include "truebearing/simulation/scenario.hpp"
#include "truebearing/study/study_sites.hpp"

namespace truebearing {
namespace {

// The log's own measurements as the runs of a comparison, one per track.
class LogScenario final : public Scenario {
 public:
  explicit LogScenario(const std::vector<Recording>& tracks) : tracks_(tracks) {}
  Recording simulate(const RunKey& key) const override { return tracks_[static_cast<std::size_t>(key.run)]; }
  const StateSpace& truth_space() const override { return *tracks_.front().truth_space; }

 private:
  const std::vector<Recording>& tracks_;
};

// A bound asks for more than a log may tell: how loud its targets are. It is left out then.
template <typename Bound>
void leave_out_unless_told(std::optional<Bound>& bound, const std::vector<Recording>& tracks,
                           const ScoringRule& scoring) {
  if (!bound) return;
  try {
    for (const Recording& track : tracks) {
      if constexpr (std::is_same_v<Bound, AngleBound>)
        static_cast<void>(bound->variances(track, scoring.from_step));
      else
        static_cast<void>(bound->variances(track, steps_at(track, scoring.times_s)));
    }
  } catch (const InputError& reason) {
    say(fmt::format("truebearing: the bound is left out: {}", reason.what()));
    bound.reset();
  }
}

}  // namespace

ScoredLog score_log(const Study& study, const std::string& log, const TrackerSet& trackers,
                    std::vector<Recording> tracks, double epoch_s, bool with_pictures) {
  ComparisonOptions options = study.comparison_options(true);
  options.runs = tracks.size();
  options.threads = 1;
  options.details = with_pictures;
  for (Recording& track : tracks)
    for (Measurement& measurement : track.measurements) measurement.time_s -= epoch_s;
  leave_out_unless_told(options.cramer_rao, tracks, options.scoring);
  leave_out_unless_told(options.angle_bound, tracks, options.scoring);
  const LogScenario scenario(tracks);
  const std::vector<NamedScenario> scenarios{{log, &scenario}};
  ScoredLog scored{compare(trackers, scenarios, options), {}};
  if (with_pictures)
    scored.pictures = picture_runs(trackers, scenarios, options, scored.comparison, sensor_sites(study));
  scored.comparison.study = study.name() + " on " + log;
  for (double& time_s : scored.comparison.time_s) time_s += epoch_s;
  return scored;
}

}  // namespace truebearing
