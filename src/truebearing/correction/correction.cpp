#include "truebearing/correction/correction.hpp"

#include <algorithm>
#include <utility>

#include "truebearing/core/covariance.hpp"
#include "truebearing/core/error.hpp"
#include "truebearing/correction/limit_kappa.hpp"

namespace truebearing {
namespace {

int member(const Ensemble& ensemble, const std::string& name, const StateSpace& space) {
  const int index = ensemble.index(name);
  if (index < 0) throw InputError("correction", "needs the tracker \"" + name + "\", which does not run beside it");
  if (ensemble.tracker(index).space() != space)
    throw InputError("correction", "the tracker \"" + name + "\" has the state " + ensemble.tracker(index).space().name,
                     "the state " + space.name);
  return index;
}

}  // namespace

Correction::Correction(std::shared_ptr<const CorrectionModel> model, const Ensemble& ensemble, CorrectionBounds bounds)
    : model_(std::move(model)),
      bounds_(std::move(bounds)),
      base_(member(ensemble, model_->base, *model_->space)),
      reference_(member(ensemble, model_->reference, *model_->space)),
      source_(member(ensemble, model_->covariance_of, *model_->space)),
      prototype_(model_->features, *model_->space, model_->frame, [&](const std::string& name) {
        return ensemble.tracker(name.empty() ? base_ : member(ensemble, name, *model_->space)).blocks();
      }) {
  model_->validate();
  bounds_.validate();
  for (const std::string& name : prototype_.companions()) companions_.push_back(member(ensemble, name, *model_->space));
  companion_records_.resize(companions_.size());
  if (bounds_.referee && !ensemble.tracker(base_).blocks().measures_position)
    throw InputError("correction", "has a referee, and \"" + model_->base + "\" measures no position",
                     "a base that measures positions, or no referee");
  reset();
}

void Correction::reset() {
  tracks_.assign(1, Track{-1, false, prototype_, {}});
  records_.assign(1, StepRecord{});
}

Correction::Track& Correction::track_of(int id) {
  auto slot = std::find_if(tracks_.begin(), tracks_.end(), [&](const Track& t) { return t.id == id; });
  if (slot == tracks_.end()) {
    slot = std::find_if(tracks_.begin(), tracks_.end(), [](const Track& t) { return !t.seen; });
    if (slot == tracks_.end()) slot = tracks_.insert(tracks_.end(), Track{id, true, prototype_, {}});
    slot->referee = {};
  }
  slot->id = id;
  slot->seen = true;
  return *slot;
}

std::span<const StepRecord> Correction::correct(const Ensemble& ensemble) {
  const std::span<const StepRecord> references = ensemble.records(reference_);
  if (records_.size() < references.size()) records_.resize(references.size());
  for (Track& track : tracks_)
    track.seen =
        std::any_of(references.begin(), references.end(), [&](const StepRecord& r) { return r.track == track.id; });

  for (std::size_t i = 0; i < references.size(); ++i) {
    const StepRecord& reference = references[i];
    const StepRecord* base = ensemble.record(base_, reference.track);
    const StepRecord* source = ensemble.record(source_, reference.track);
    for (std::size_t c = 0; c < companions_.size(); ++c)
      companion_records_[c] = ensemble.record(companions_[c], reference.track);
    if (!base || !source || base->status == StepStatus::failed) {
      records_[i] = reference;
      records_[i].correction = CorrectionOutcome{.base_x = reference.x, .base_P = reference.P};
      continue;
    }
    Track& track = track_of(reference.track);
    track.extractor.extract(*base, companion_records_, features_);
    if (bounds_.referee) track.referee.judge(*base, *bounds_.referee);
    correct_record(*base, reference, *source, track, records_[i]);
  }
  return {records_.data(), references.size()};
}

void Correction::correct_record(const StepRecord& base, const StepRecord& reference, const StepRecord& source,
                                Track& track, StepRecord& corrected) {
  const FuzzyNetwork& network = model_->network;
  const FrameRotation& rotation = track.extractor.rotation();
  corrected = base;
  corrected.correction = CorrectionOutcome{.base_x = base.x, .base_P = base.P};
  corrected.x = reference.x;
  corrected.P = reference.P;
  if (!features_.allFinite()) return;  // g = 0

  network.strengths(features_, phi_);
  BoundedVector output = network.output(phi_);
  if (model_->output_in_sigma) output.array() *= rotation.covariance(base.P).diagonal().array().sqrt();
  const BoundedVector d = base.x + rotation.vector(output) - reference.x;
  const BoundedMatrix P_c = rotation.covariance(model_->head_covariance(phi_, rotation.covariance(source.P)));
  const Limited limited = limit_kappa(reference.P, d, bounds_.kappa);
  const bool gated = bounds_.gate && model_->gate;
  double g = gated ? model_->gate->weight(features_, disagreement(d, P_c, reference.P)) : 1.0;
  if (bounds_.referee) {
    g *= track.referee.weight(*bounds_.referee);
    track.referee.predict(base.time_s, reference.x + limited.d, reference.x);
  }

  const BoundedVector x = reference.x + g * limited.d;
  // Written as a change of P_reference: nothing to correct leaves the covariance as it is, to the bit.
  const BoundedMatrix P =
      reference.P + g * (P_c - reference.P) + g * (1.0 - g) * limited.d.lazyProduct(limited.d.transpose());
  if (!x.allFinite() || !is_covariance(P)) return;  // numbers of any size may overflow or cancel: g = 0
  corrected.x = x;
  corrected.P = P;
  corrected.correction->gate = g;
  corrected.correction->limited = limited.limited;
  corrected.correction->distance_sigmas = g * limited.distance_sigmas;
}

}  // namespace truebearing
