// SPDX-License-Identifier: Apache-2.0
// The trackers of a study on one log, row by row: `truebearing track` and `smooth`.
#pragma once

#include <fmt/format.h>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "app/track_output.hpp"
#include "app/track_report.hpp"
#include "truebearing/evaluation/late_rows.hpp"
#include "truebearing/study/log_fit.hpp"
#include "truebearing/study/study.hpp"

namespace truebearing {

/// The trackers on a log: what they do is written, counted and remembered for the report.
class TrackRun {
 public:
  /// records, events: where these are written, or empty. measured: columns of the log.
  TrackRun(const Study& study, const std::string& records, const std::string& events, int measured,
           const RecordingOptions& reading = {})
      : TrackRun(study.make_tracker_set()) {
    sources_ = reading.sources;
    if (reading.late_keep_s > 0.0) late_.emplace(trackers_, reading.late_keep_s);
    if (!records.empty()) records_.emplace(records, trackers_, measured, sources_, late_.has_value());
    if (!events.empty()) events_.emplace(events);
  }
  /// Which only counts and remembers.
  explicit TrackRun(TrackerSet trackers) : trackers_(std::move(trackers)) {
    for (int i = 0; i < trackers_.size(); ++i) all_.emplace_back().name = trackers_.name(i);
  }

  const TrackerSet& trackers() const { return trackers_; }
  const std::vector<Followed>& all() const { return all_; }
  const LogContents& contents() const { return contents_; }

  /// The log's clock is that of the study from epoch_s on.
  void begin_at(double epoch_s) { contents_.epoch_s = epoch_s; }
  /// All measurements of a log or a track, before their first step, where a tracker looks back.
  void foresee(std::vector<Measurement> measurements) {
    for (Measurement& measurement : measurements) measurement.time_s -= contents_.epoch_s;
    trackers_.foresee(measurements);
  }
  /// Several tracks one after the other, each of which the trackers follow afresh and call by its number.
  void begin_track(int number) {
    trackers_.reset();
    number_ = number;
    if (records_) records_->wait_for_all();
  }

  /// False of a row that came too late and is left out.
  bool step(const Measurement& measurement) {
    ++contents_.measurements;
    contents_.guess |= measurement.guess.has_value();
    contents_.last_time_s = measurement.time_s;
    if (late_) {
      const auto publish = [&](const Measurement& taken, bool revised) {
        for (std::size_t i = 0; i < all_.size(); ++i) take(i, taken.time_s + contents_.epoch_s, revised);
      };
      return contents_.epoch_s == 0.0 ? late_->step(trackers_, measurement, publish)
                                      : late_->step(trackers_, in_study_time(measurement), publish);
    }
    if (contents_.epoch_s == 0.0)
      trackers_.step(measurement);
    else
      trackers_.step(in_study_time(measurement));
    for (std::size_t i = 0; i < all_.size(); ++i) take(i, measurement.time_s, false);
    return true;
  }

  /// What became of late rows; empty where there were none.
  std::string late_note() const {
    if (!late_ || late_->taken() + late_->too_late() == 0) return {};
    return fmt::format("{} late rows put where they belong, {} steps run again for them, {} rows too late",
                       late_->taken(), late_->again(), late_->too_late());
  }

  void flush() {
    if (records_) records_->flush();
    if (events_) events_->flush();
  }

  void end_track(const Recording::Counts& rows) {
    contents_.missing += static_cast<std::size_t>(rows.missing);
    for (std::size_t i = 0; i < all_.size(); ++i) {
      const int entry = static_cast<int>(i);
      add(trackers_.counts(entry), all_[i].counts);
      for (const StepRecord& record : trackers_.records(entry))
        all_[i].last.push_back(as_in_log(record, contents_.last_time_s));
      seen_events_.clear();
    }
  }

  void finish() {
    if (records_) records_->finish();
    if (events_) events_->finish();
  }

 private:
  static void add(const TrackerCounts& counts, TrackerCounts& sum) {
    sum.missing += counts.missing;
    sum.repeated += counts.repeated;
    sum.out_of_order += counts.out_of_order;
    sum.gated += counts.gated;
    sum.failed += counts.failed;
  }

  Measurement in_study_time(Measurement measurement) const {
    measurement.time_s -= contents_.epoch_s;
    return measurement;
  }

  bool is_as_in_log() const { return number_ == 0 && contents_.epoch_s == 0.0; }

  // A record of the step at time_s with the track's number and the time that the log has.
  StepRecord as_in_log(StepRecord record, double time_s) const {
    record.track += number_;
    record.time_s = record.time_s == time_s - contents_.epoch_s ? time_s : record.time_s + contents_.epoch_s;
    return record;
  }

  void take(std::size_t i, double time_s, bool revised) {
    for (const StepRecord& record : trackers_.records(static_cast<int>(i)))
      is_as_in_log() ? take(i, record, revised) : take(i, as_in_log(record, time_s), revised);
    const std::span<const TrackEvent> events = trackers_.events(static_cast<int>(i));
    seen_events_.resize(all_.size());
    for (; seen_events_[i] < events.size(); ++seen_events_[i]) {
      TrackEvent event = events[seen_events_[i]];
      event.time_s += contents_.epoch_s;
      if (events_) events_->add(all_[i].name, event);
      all_[i].events.push_back(event);
    }
  }

  void take(std::size_t i, const StepRecord& record, bool revised) {
    if (records_) records_->add(all_[i].name, record, revised);
    if (revised) return;  // it has been counted
    ++all_[i].records;
    all_[i].innovations.add(record);
    if (!sources_.empty() && record.innovation)
      all_[i].of_sensors[sources_[static_cast<std::size_t>(record.source)].name].add(record);
  }

  TrackerSet trackers_;
  std::optional<LateRows> late_;
  std::vector<Source> sources_;
  std::vector<Followed> all_;
  std::optional<RecordOutput> records_;
  std::optional<EventOutput> events_;
  std::vector<std::size_t> seen_events_;  // of each tracker, on this track
  LogContents contents_;
  int number_ = 0;
};

}  // namespace truebearing
