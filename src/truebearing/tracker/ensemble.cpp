// SPDX-License-Identifier: Apache-2.0
#include "truebearing/tracker/ensemble.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "truebearing/core/error.hpp"

namespace truebearing {

int Ensemble::add(std::string name, std::unique_ptr<Tracker> tracker) {
  if (index(name) >= 0) throw InputError("ensemble", "has two members named \"" + name + "\"", "unique names");
  members_.push_back({std::move(name), std::move(tracker), {}});
  return size() - 1;
}

int Ensemble::index(std::string_view name) const {
  const auto found = std::find_if(members_.begin(), members_.end(), [&](const Member& m) { return m.name == name; });
  return found == members_.end() ? -1 : static_cast<int>(found - members_.begin());
}

void Ensemble::step(const Measurement& measurement) {
  for (Member& member : members_) member.records = member.tracker->step(measurement);
}

void Ensemble::reset() {
  for (Member& member : members_) {
    member.tracker->reset();
    member.records = {};
  }
}

std::string Ensemble::assign(const Ensemble& other) {
  for (std::size_t i = 0; i < members_.size(); ++i) {
    members_[i].records = {};
    if (!members_[i].tracker->assign(*other.members_[i].tracker)) return members_[i].name;
  }
  return {};
}

bool Ensemble::gains_together() const {
  return std::any_of(members_.begin(), members_.end(), [](const Member& m) { return m.tracker->pack() != nullptr; });
}

void Ensemble::foresee(std::span<const Measurement> measurements) {
  for (Member& member : members_) member.tracker->foresee(measurements);
}

Ensemble Ensemble::fresh() const {
  Ensemble copy;
  for (const Member& member : members_) copy.add(member.name, member.tracker->fresh());
  return copy;
}

const StepRecord* Ensemble::record(int member, int track) const {
  const std::span<const StepRecord> all = records(member);
  const auto found = std::find_if(all.begin(), all.end(), [&](const StepRecord& r) { return r.track == track; });
  return found == all.end() ? nullptr : &*found;
}

EnsemblePack::EnsemblePack(std::vector<Ensemble*> ensembles)
    : ensembles_(std::move(ensembles)), lanes_(ensembles_.size()) {
  if (ensembles_.empty()) throw std::invalid_argument("there is an ensemble to step");
  for (const Ensemble::Member& member : ensembles_.front()->members_)
    packs_.push_back(ensembles_.size() > 1 ? member.tracker->pack() : nullptr);
}

void EnsemblePack::step(std::span<const Measurement* const> measurements) {
  for (std::size_t member = 0; member < packs_.size(); ++member) {
    for (std::size_t i = 0; i < lanes_.size(); ++i) {
      Tracker& tracker = *ensembles_[i]->members_[member].tracker;
      lanes_[i] = {&tracker, measurements[i]};
      if (!packs_[member] && measurements[i]) lanes_[i].records = tracker.step(*measurements[i]);
    }
    if (packs_[member]) packs_[member]->step(lanes_);
    for (std::size_t i = 0; i < lanes_.size(); ++i)
      if (measurements[i]) ensembles_[i]->members_[member].records = lanes_[i].records;
  }
}

}  // namespace truebearing
