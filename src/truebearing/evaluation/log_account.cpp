// SPDX-License-Identifier: Apache-2.0
#include "truebearing/evaluation/log_account.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "truebearing/core/constants.hpp"

namespace truebearing {
namespace {

// The plane where any tracker has it: the others are drawn beside it where they can be.
const StateSpace& drawn_space(const TrackerSet& trackers) {
  for (int i = 0; i < trackers.size(); ++i)
    if (begins_in_plane(trackers.space(i))) return trackers.space(i);
  return trackers.space(0);
}

void add_innovation(const StepRecord& record, double time_s, TrackerOnLog::Innovations& innovations) {
  const Innovation& innovation = *record.innovation;
  const bool told = innovation.z.size() == innovation.nu.size();
  const bool first_is_there = !told || std::isfinite(innovation.z[0]);
  innovations.time_s.push_back(time_s);
  innovations.sigmas.push_back(first_is_there ? innovation.nu[0] / std::sqrt(innovation.S(0, 0)) : kNaN);
  innovations.nis.push_back(innovation.nis);
  innovations.freedom.push_back(
      static_cast<double>(told ? innovation.z.array().isFinite().count() : innovation.nu.size()));
  innovations.used.push_back(record.status == StepStatus::ok);
}

}  // namespace

LogFollower::LogFollower(const TrackerSet& trackers, SensorSites sites)
    : trackers_(trackers.fresh()), sites_(std::move(sites)), canvas_(drawn_space(trackers)) {
  account_.picture.in_plane = canvas_.in_plane();
  account_.picture.component = canvas_.component();
  for (int i = 0; i < trackers_.size(); ++i) account_.trackers.push_back({trackers_.name(i), {}, {}});
}

void LogFollower::follow(const Recording& recording, int number, double epoch_s) {
  trackers_.reset();
  canvas_.add_measured(recording, sites_, account_.picture);
  if (account_.picture.beam.time_s.empty()) canvas_.add_beam(recording, account_.picture);
  std::vector<TrackerCounts> before(account_.trackers.size());
  std::vector<Measurement> measurements = recording.measurements;
  for (Measurement& measurement : measurements) measurement.time_s -= epoch_s;
  trackers_.foresee(measurements);
  for (std::size_t step = 0; step < measurements.size(); ++step) {
    const Measurement &logged = recording.measurements[step], &measurement = measurements[step];
    for (std::size_t i = 0; i < before.size(); ++i) before[i] = trackers_.counts(static_cast<int>(i));
    trackers_.step(measurement);
    for (std::size_t i = 0; i < before.size(); ++i) {
      const int entry = static_cast<int>(i);
      std::vector<StepRecord> records(trackers_.records(entry).begin(), trackers_.records(entry).end());
      for (StepRecord& record : records) {
        record.track += number;
        record.time_s = record.time_s == measurement.time_s ? logged.time_s : record.time_s + epoch_s;
        if (record.innovation && record.innovation->nu.size() > 0)
          add_innovation(record, record.time_s, account_.trackers[i].innovations);
      }
      canvas_.add_records(records, trackers_.name(entry), account_.picture.tracks);
      take_step(i, before[i], logged.time_s);
    }
  }
}

void LogFollower::take_step(std::size_t tracker, const TrackerCounts& before, double time_s) {
  const int entry = static_cast<int>(tracker);
  const TrackerCounts now = trackers_.counts(entry);
  const auto add = [&](const char* why, int TrackerCounts::*count, double nis) {
    if (now.*count > before.*count) account_.trackers[tracker].not_used.push_back({time_s, why, nis});
  };
  double nis = kNaN;
  for (const StepRecord& record : trackers_.records(entry))
    if (record.status == StepStatus::rejected && record.innovation) nis = std::fmax(nis, record.innovation->nis);
  add("missing", &TrackerCounts::missing, kNaN);
  add("repeated", &TrackerCounts::repeated, kNaN);
  add("late", &TrackerCounts::out_of_order, kNaN);
  add("gated", &TrackerCounts::gated, nis);
  add("failed", &TrackerCounts::failed, kNaN);
}

}  // namespace truebearing
