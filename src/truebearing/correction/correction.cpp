// SPDX-License-Identifier: Apache-2.0
#include "truebearing/correction/correction.hpp"

#include <algorithm>
#include <cmath>
#include <type_traits>
#include <utility>

#include "truebearing/core/covariance.hpp"
#include "truebearing/core/error.hpp"
#include "truebearing/core/unfilled.hpp"
#include "truebearing/core/with_count.hpp"
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
  corrected.source = step.source;
  corrected.x = reference.x;
  corrected.P = reference.P;
  corrected.correction.emplace(Unfilled());
}

// What the weights g of what a correction says make of the covariances: a and b are the roots of g_i g_j and (1 - g_i)
// (1 - g_j), of positions (0) and velocities (1).
struct Blend {
  double a[2][2];
  double b[2][2];

  Blend(double position, double velocity) {
    const double g[2] = {position, velocity};
    for (int i = 0; i < 2; ++i)
      for (int j = 0; j < 2; ++j) {
        a[i][j] = g[i] == g[j] ? g[i] : std::sqrt(g[i] * g[j]);
        b[i][j] = g[i] == g[j] ? 1.0 - g[i] : std::sqrt((1.0 - g[i]) * (1.0 - g[j]));
      }
  }

  // Written as a change of P_reference: nothing to correct leaves the covariance as it is, to the bit. False where the
  // result P is no covariance.
  bool covariance(const BoundedMatrix& P_c, const BoundedMatrix& P_reference, const BoundedVector& d,
                  BoundedMatrix& P) const {
    const auto n = static_cast<int>(d.size());
    bool valid = false;
    P.resize(n, n);
    with_count(n, [&]<int N>(std::integral_constant<int, N>) {
      const double *c = P_c.data(), *reference = P_reference.data();
      Eigen::Matrix<double, N, N> blended;
      for (int j = 0; j < N; ++j)
        for (int i = 0; i < N; ++i, ++c, ++reference) {
          const double a_ij = a[i >= N / 2][j >= N / 2], b_ij = b[i >= N / 2][j >= N / 2];
          blended(i, j) = *reference + a_ij * (*c - *reference) - (1.0 - a_ij - b_ij) * *reference +
                          a_ij * b_ij * d.data()[i] * d.data()[j];
        }
      valid = is_covariance(blended);
      Eigen::Map<Eigen::Matrix<double, N, N>>(P.data()) = blended;
    });
    return valid;
  }
};

// The weights of the components of a state (n): g, times those of its positions and velocities.
BoundedVector component_weights(double g, const Referee::Weights& w, Eigen::Index n) {
  BoundedVector G(n);
  G << BoundedVector::Constant(n / 2, g * w.position), BoundedVector::Constant(n - n / 2, g * w.velocity);
  return G;
}

}  // namespace

Correction::Correction(std::shared_ptr<const CorrectionModel> model, const Ensemble& ensemble, CorrectionBounds bounds)
    : model_(std::move(model)), bounds_(std::move(bounds)), inputs_(model_->design, *model_->space, ensemble) {
  model_->validate();
  bounds_.validate();
  if (bounds_.referee && !ensemble.tracker(inputs_.base()).blocks().measures_position)
    throw InputError("correction", "has a referee, and \"" + model_->design.base + "\" measures no position",
                     "a base that measures positions, or no referee");
  if (!bounds_.fallback.empty()) fallback_ = member_index(ensemble, bounds_.fallback, *model_->space);
  if (bounds_.gate && model_->gate) {
    gate_ = model_->gate;
    gate_->intervals.high_s = std::min(gate_->intervals.high_s, bounds_.longest_interval_s);
  }
  reset();
}

void Correction::reset() {
  tracks_.assign(1, Track{-1, false, inputs_.extractor(), first_memory(model_->network), {}, {}});
  records_.assign(1, StepRecord{});
  accounts_.assign(1, CorrectionAccount{});
  given_ = 0;
}

Correction::Track& Correction::track_of(int id) {
  auto slot = std::find_if(tracks_.begin(), tracks_.end(), [&](const Track& t) { return t.id == id; });
  if (slot == tracks_.end()) {
    slot = std::find_if(tracks_.begin(), tracks_.end(), [](const Track& t) { return !t.seen; });
    if (slot == tracks_.end()) slot = tracks_.insert(tracks_.end(), Track{id, true, inputs_.extractor(), {}, {}, {}});
    slot->memory = first_memory(model_->network);
    slot->referee = slot->handover = {};
  }
  slot->id = id;
  slot->seen = true;
  return *slot;
}

std::span<const StepRecord> Correction::correct(const Ensemble& ensemble) {
  const std::span<const StepRecord> references = ensemble.records(inputs_.reference());
  if (records_.size() < references.size()) records_.resize(references.size());
  if (accounts_.size() < references.size()) accounts_.resize(references.size());
  given_ = references.size();
  for (Track& track : tracks_)
    track.seen =
        std::any_of(references.begin(), references.end(), [&](const StepRecord& r) { return r.track == track.id; });

  for (std::size_t i = 0; i < references.size(); ++i) {
    accounts_[i].features.resize(0);
    CorrectionInputs::Records step = inputs_.records(ensemble, references[i].track);
    if (!step.complete()) {
      begin_record(references[i], references[i], records_[i]);
      continue;
    }
    Track& track = track_of(references[i].track);
    handed_over_ = 0.0;
    if (fallback_ >= 0)
      step.reference = &trusted(*step.base, references[i], ensemble.record(fallback_, references[i].track), track);
    inputs_.extract(ensemble, *step.base, track.extractor, features_);
    if (bounds_.referee) track.referee.judge(*step.base, *bounds_.referee);
    correct_record(step, track, records_[i], accounts_[i]);
  }
  return {records_.data(), references.size()};
}

// The reference, or the fallback where that lately agreed better with the measurements: what lies between them by the referee's weights.
const StepRecord& Correction::trusted(const StepRecord& base, const StepRecord& reference, const StepRecord* fallback,
                                      Track& track) {
  if (!fallback || fallback->status != reference.status || base.status != reference.status) return reference;
  track.handover.judge(base, *bounds_.referee);
  const BoundedVector d = reference.x - fallback->x;
  const BoundedVector G = component_weights(1.0, track.handover.weights(*bounds_.referee), d.size());
  const BoundedVector x = fallback->x + G.cwiseProduct(d);
  const bool valid = Blend(G[0], G[G.size() - 1]).covariance(reference.P, fallback->P, d, trusted_.P);
  if (!x.allFinite() || !valid) return reference;
  handed_over_ = 1.0 - G.mean();
  trusted_.x = x;
  trusted_.track = reference.track;
  trusted_.time_s = reference.time_s;
  trusted_.status = reference.status;
  if (base.status == StepStatus::ok) track.handover.remember(base, reference.x, *fallback, x);
  return trusted_;
}

void Correction::correct_record(const CorrectionInputs::Records& step, Track& track, StepRecord& corrected,
                                CorrectionAccount& account) {
  const StepRecord& base = *step.base;
  const StepRecord& reference = *step.reference;
  begin_record(base, reference, corrected);
  corrected.correction->base_x = base.x;
  corrected.correction->base_P = base.P;
  corrected.correction->handed_over = handed_over_;
  if (!features_.allFinite() || !step.agree()) return;  // g = 0

  // What it remembers are the steps that used a measurement: one that used none leaves no trace.
  memory_ = track.memory;
  answer(model_->network, features_, memory_, answer_);
  if (base.status == StepStatus::ok) track.memory = memory_;
  const OutputUnits units = inputs_.units(track.extractor, base);
  const BoundedVector wanted = base.x + units.state(answer_.y) - reference.x;
  const BoundedMatrix P_c = units.in_frame(answer_.covariance(units.in_frame(step.source->P)));
  const SafeDistance distance(reference.P);
  const Limited limited = limit_kappa(distance, wanted, bounds_.kappa);
  const BoundedVector& d = limited.d;
  const double contradicts = gate_ ? disagreement(wanted, P_c, reference.P) : 0.0;
  const double g = gate_ ? gate_->weight(features_, track.extractor.intervals(), contradicts) : 1.0;
  const Referee::Weights w = bounds_.referee ? track.referee.weights(*bounds_.referee) : Referee::Weights{};
  account = {features_, g, w, track.extractor.intervals(), contradicts, limited.wanted_sigmas};
  const BoundedVector G = component_weights(g, w, reference.x.size());

  // Where its parts have weights of their own, a correction may become longer than it was.
  const bool apart = w.position != w.velocity;
  const BoundedVector weighted =
      apart ? limit_kappa(distance, G.cwiseProduct(d), bounds_.kappa).d : BoundedVector(g * w.position * d);
  const BoundedVector x = within_kappa(reference.x, distance, weighted, bounds_.kappa);
  if (bounds_.referee && base.status == StepStatus::ok) track.referee.remember(base, reference.x + d, reference, x);

  BoundedMatrix P;
  const bool valid = Blend(G[0], G[G.size() - 1]).covariance(P_c, reference.P, d, P);
  if (!x.allFinite() || !valid) return;  // numbers of any size may overflow or cancel: g = 0
  corrected.x = x;
  corrected.P = P;
  corrected.correction->gate = G.mean();
  corrected.correction->limited = limited.limited;
  corrected.correction->distance_sigmas = apart ? distance.of(weighted) : G[0] * limited.distance_sigmas;
}

}  // namespace truebearing
