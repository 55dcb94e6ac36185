#include "truebearing/correction/correction.hpp"

#include <algorithm>
#include <utility>

#include "truebearing/core/covariance.hpp"
#include "truebearing/core/error.hpp"
#include "truebearing/correction/limit_kappa.hpp"

namespace truebearing {
namespace {

// The reference's estimate at `step`, and nothing of what a tracker predicted, innovated or gained: the slot is one of
// corrected records, whose blocks of that kind nobody fills.
void begin_record(const StepRecord& step, const StepRecord& reference, StepRecord& corrected) {
  corrected.track = step.track;
  corrected.time_s = step.time_s;
  corrected.status = step.status;
  corrected.space = step.space;
  corrected.sensor = step.sensor;
  corrected.x = reference.x;
  corrected.P = reference.P;
  corrected.correction.emplace();
}

}  // namespace

Correction::Correction(std::shared_ptr<const CorrectionModel> model, const Ensemble& ensemble, CorrectionBounds bounds)
    : model_(std::move(model)), bounds_(std::move(bounds)), inputs_(model_->design, *model_->space, ensemble) {
  model_->validate();
  bounds_.validate();
  if (bounds_.referee && !ensemble.tracker(inputs_.base()).blocks().measures_position)
    throw InputError("correction", "has a referee, and \"" + model_->design.base + "\" measures no position",
                     "a base that measures positions, or no referee");
  reset();
}

void Correction::reset() {
  tracks_.assign(1, Track{-1, false, inputs_.extractor(), {}});
  records_.assign(1, StepRecord{});
}

Correction::Track& Correction::track_of(int id) {
  auto slot = std::find_if(tracks_.begin(), tracks_.end(), [&](const Track& t) { return t.id == id; });
  if (slot == tracks_.end()) {
    slot = std::find_if(tracks_.begin(), tracks_.end(), [](const Track& t) { return !t.seen; });
    if (slot == tracks_.end()) slot = tracks_.insert(tracks_.end(), Track{id, true, inputs_.extractor(), {}});
    slot->referee = {};
  }
  slot->id = id;
  slot->seen = true;
  return *slot;
}

std::span<const StepRecord> Correction::correct(const Ensemble& ensemble) {
  const std::span<const StepRecord> references = ensemble.records(inputs_.reference());
  if (records_.size() < references.size()) records_.resize(references.size());
  for (Track& track : tracks_)
    track.seen =
        std::any_of(references.begin(), references.end(), [&](const StepRecord& r) { return r.track == track.id; });

  for (std::size_t i = 0; i < references.size(); ++i) {
    const CorrectionInputs::Records step = inputs_.records(ensemble, references[i].track);
    if (!step.complete()) {
      begin_record(references[i], references[i], records_[i]);
      continue;
    }
    Track& track = track_of(references[i].track);
    inputs_.extract(ensemble, *step.base, track.extractor, features_);
    if (bounds_.referee) track.referee.judge(*step.base, *bounds_.referee);
    correct_record(step, track, records_[i]);
  }
  return {records_.data(), references.size()};
}

void Correction::correct_record(const CorrectionInputs::Records& step, Track& track, StepRecord& corrected) {
  const StepRecord& base = *step.base;
  const StepRecord& reference = *step.reference;
  begin_record(base, reference, corrected);
  corrected.correction->base_x = base.x;
  corrected.correction->base_P = base.P;
  if (!features_.allFinite()) return;  // g = 0

  model_->network.strengths(features_, phi_);
  const OutputUnits units = inputs_.units(track.extractor, base);
  const BoundedVector d = base.x + units.state(model_->network.output(phi_)) - reference.x;
  const BoundedMatrix P_c = units.in_frame(model_->head_covariance(phi_, units.in_frame(step.source->P)));
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
