// SPDX-License-Identifier: Apache-2.0
// Ensemble: several trackers stepped on the same measurements, their records aligned by track. Everything that compares
// or corrects trackers looks at one ensemble, so that no tracker runs twice.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "truebearing/tracker/tracker.hpp"

namespace truebearing {

class Ensemble {
 public:
  Ensemble() = default;

  /// Adds a member and returns its index. Names are unique; throws InputError for a second one.
  int add(std::string name, std::unique_ptr<Tracker> tracker);

  /// Index of the member of that name, -1 where there is none.
  int index(std::string_view name) const;
  int size() const { return static_cast<int>(members_.size()); }
  const std::string& name(int member) const { return at(member).name; }
  const Tracker& tracker(int member) const { return *at(member).tracker; }

  /// Steps every member on the measurement.
  void step(const Measurement& measurement);
  void reset();
  /// All measurements of a run, after reset(), for the members that look back.
  void foresee(std::span<const Measurement> measurements);
  Ensemble fresh() const;
  /// Its members become copies of the other's (Tracker::assign()), without records. The name of one that cannot, else
  /// empty.
  std::string assign(const Ensemble& other);

  /// Whether several of them cost less stepped together (EnsemblePack) than one after another.
  bool gains_together() const;

  /// The records of the last step. Valid until the next step.
  std::span<const StepRecord> records(int member) const { return at(member).records; }
  /// The member's record for that track, nullptr where it has none.
  const StepRecord* record(int member, int track) const;

 private:
  friend class EnsemblePack;

  struct Member {
    std::string name;
    std::unique_ptr<Tracker> tracker;
    std::span<const StepRecord> records;
  };
  const Member& at(int member) const { return members_[static_cast<std::size_t>(member)]; }

  std::vector<Member> members_;
};

/// Ensembles that are stepped together, each on a measurement of its own: a member's trackers in all of them side by side
/// (tracker_pack.hpp), where that is of use.
class EnsemblePack {
 public:
  /// `ensembles` (1 or more, of which kPackLanes are side by side) were made by fresh() from one, and stay where they are.
  explicit EnsemblePack(std::vector<Ensemble*> ensembles);

  std::size_t size() const { return ensembles_.size(); }
  /// One for each ensemble, nullptr where it has none now: its records stay those of its last step.
  void step(std::span<const Measurement* const> measurements);

 private:
  std::vector<Ensemble*> ensembles_;
  std::vector<std::unique_ptr<TrackerPack>> packs_;  // [member]; nullptr where they are stepped one by one
  std::vector<TrackerPack::Lane> lanes_;
};

}  // namespace truebearing
