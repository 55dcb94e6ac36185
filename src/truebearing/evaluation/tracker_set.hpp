// SPDX-License-Identifier: Apache-2.0
// TrackerSet: the trackers of one comparison. Plain and corrected ones share one ensemble, so that each filter runs
// once however many corrections look at it.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "truebearing/correction/correction.hpp"
#include "truebearing/tracker/ensemble.hpp"

namespace truebearing {

class TrackerSet {
 public:
  explicit TrackerSet(Ensemble ensemble) : ensemble_(std::move(ensemble)) {}

  /// Shows the ensemble's member of that name, or a bounded correction of members under a name of its own, as the next
  /// entry.
  void show_member(const std::string& name);
  void show_correction(std::string name, std::shared_ptr<const CorrectionModel> model, CorrectionBounds bounds);

  int size() const { return static_cast<int>(entries_.size()); }
  const std::string& name(int entry) const { return at(entry).name; }
  const StateSpace& space(int entry) const;

  void step(const Measurement& measurement);
  /// The records of the last step. Valid until the next step.
  std::span<const StepRecord> records(int entry) const { return at(entry).records; }
  /// The correction of that entry, with its accounts of the last step; nullptr of what is none.
  const Correction* correction(int entry) const;
  TrackerCounts counts(int entry) const;
  /// What it noticed since reset(): a correction notices what its base does.
  std::span<const TrackEvent> events(int entry) const;

  void reset();
  /// All measurements of a run, after reset(), for the trackers that look back.
  void foresee(std::span<const Measurement> measurements) { ensemble_.foresee(measurements); }
  TrackerSet fresh() const;
  /// How many copies are best stepped together (TrackerSetPack), of `runs` at most: one, where several gain nothing.
  std::size_t best_together(std::size_t runs) const;
  /// Becomes a copy of `other` as it stands, without the records of its last step, where that was made by fresh() from
  /// this one or from the same. The name of a tracker that cannot be copied, and nothing is of use then; else empty.
  std::string assign(const TrackerSet& other);

 private:
  friend class TrackerSetPack;

  void correct();
  struct Entry {
    std::string name;
    int member;      // of the ensemble; the base's where this is a correction
    int correction;  // -1 where it is a member itself
    std::span<const StepRecord> records;
  };
  const Entry& at(int entry) const { return entries_[static_cast<std::size_t>(entry)]; }

  Ensemble ensemble_;
  std::vector<Correction> corrections_;
  std::vector<Entry> entries_;
};

/// Copies of one set that are stepped together, each on a measurement of its own, as the runs of a comparison are: see
/// EnsemblePack.
class TrackerSetPack {
 public:
  /// copies: 1 or more; see TrackerSet::best_together().
  TrackerSetPack(const TrackerSet& trackers, std::size_t copies);

  std::size_t size() const { return sets_.size(); }
  TrackerSet& set(std::size_t i) { return sets_[i]; }
  /// One for each copy, nullptr where it has none now: its records stay those of its last step.
  void step(std::span<const Measurement* const> measurements);

 private:
  std::vector<TrackerSet> sets_;
  EnsemblePack ensembles_;
};

}  // namespace truebearing
