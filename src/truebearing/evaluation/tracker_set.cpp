// SPDX-License-Identifier: Apache-2.0
#include "truebearing/evaluation/tracker_set.hpp"

#include <algorithm>
#include <utility>

#include "truebearing/core/error.hpp"

namespace truebearing {
namespace {

std::vector<TrackerSet> copies_of(const TrackerSet& trackers, std::size_t copies) {
  std::vector<TrackerSet> sets;
  for (std::size_t i = 0; i < copies; ++i) sets.push_back(trackers.fresh());
  return sets;
}

}  // namespace

void TrackerSet::show_member(const std::string& name) {
  const int member = ensemble_.index(name);
  if (member < 0) throw InputError("trackers", "there is no tracker \"" + name + "\"");
  entries_.push_back({name, member, -1, {}});
}

void TrackerSet::show_correction(std::string name, std::shared_ptr<const CorrectionModel> model,
                                 CorrectionBounds bounds) {
  const int base = ensemble_.index(model->design.base);
  corrections_.emplace_back(std::move(model), ensemble_, std::move(bounds));
  entries_.push_back({std::move(name), base, static_cast<int>(corrections_.size()) - 1, {}});
}

const StateSpace& TrackerSet::space(int entry) const {
  return ensemble_.tracker(at(entry).member).space();
}

void TrackerSet::step(const Measurement& measurement) {
  ensemble_.step(measurement);
  correct();
}

// The ensemble's last step, and what the entries show of it.
void TrackerSet::correct() {
  for (Entry& entry : entries_)
    entry.records = entry.correction < 0 ? ensemble_.records(entry.member)
                                         : corrections_[static_cast<std::size_t>(entry.correction)].correct(ensemble_);
}

const Correction* TrackerSet::correction(int entry) const {
  const int place = at(entry).correction;
  return place < 0 ? nullptr : &corrections_[static_cast<std::size_t>(place)];
}

TrackerCounts TrackerSet::counts(int entry) const {
  return ensemble_.tracker(at(entry).member).counts();
}

std::span<const TrackEvent> TrackerSet::events(int entry) const {
  return ensemble_.tracker(at(entry).member).events();
}

void TrackerSet::reset() {
  ensemble_.reset();
  for (Correction& correction : corrections_) correction.reset();
  for (Entry& entry : entries_) entry.records = {};
}

std::string TrackerSet::assign(const TrackerSet& other) {
  if (std::string name = ensemble_.assign(other.ensemble_); !name.empty()) return name;
  corrections_ = other.corrections_;
  for (Entry& entry : entries_) entry.records = {};
  return {};
}

TrackerSet TrackerSet::fresh() const {
  TrackerSet copy(ensemble_.fresh());
  copy.corrections_ = corrections_;
  copy.entries_ = entries_;
  copy.reset();
  return copy;
}

std::size_t TrackerSet::best_together(std::size_t runs) const {
  constexpr std::size_t kFewest = 4;  // a step of a pack takes as long as two or three trackers, however few are in it
  return ensemble_.gains_together() && runs >= kFewest ? std::min(runs, std::size_t{kPackLanes}) : 1;
}

TrackerSetPack::TrackerSetPack(const TrackerSet& trackers, std::size_t copies)
    : sets_(copies_of(trackers, copies)), ensembles_([&] {
        std::vector<Ensemble*> ensembles;
        for (TrackerSet& set : sets_) ensembles.push_back(&set.ensemble_);
        return ensembles;
      }()) {}

void TrackerSetPack::step(std::span<const Measurement* const> measurements) {
  ensembles_.step(measurements);
  for (std::size_t i = 0; i < sets_.size(); ++i)
    if (measurements[i]) sets_[i].correct();
}

}  // namespace truebearing
