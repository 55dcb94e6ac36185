// SPDX-License-Identifier: Apache-2.0
#include "truebearing/correction/correction.hpp"

#include <algorithm>
#include <cmath>
#include <type_traits>
#include <utility>

#include "truebearing/core/covariance.hpp"
#include "truebearing/core/error.hpp"
#include "truebearing/core/unfilled.hpp"
#include "truebearing/correction/limit_kappa.hpp"
#include "truebearing/correction/plane_covariance_kernel.hpp"

namespace truebearing {
namespace {

// Of N components, or of as many as a state may have where N is Eigen::Dynamic.
template <int N>
inline constexpr int kRoom = N > 0 ? N : kMaxDimension;
template <int N>
using StateVector = Eigen::Matrix<double, N, 1, 0, kRoom<N>, 1>;
template <int N>
using StateMatrix = Eigen::Matrix<double, N, N, 0, kRoom<N>, kRoom<N>>;

// Calls body with the number of components as a constant, for states that are often corrected: of a line, of Lorenz'
// system, of the plane and of space.
template <typename Body>
auto with_state_size(Eigen::Index n, const Body& body) {
  switch (n) {
    case 2:
      return body(std::integral_constant<int, 2>{});
    case 3:
      return body(std::integral_constant<int, 3>{});
    case 4:
      return body(std::integral_constant<int, 4>{});
    case 6:
      return body(std::integral_constant<int, 6>{});
    default:
      return body(std::integral_constant<int, Eigen::Dynamic>{});
  }
}

template <int N>
auto of_size(const BoundedVector& x) {
  return Eigen::Map<const StateVector<N>>(x.data(), x.size());
}
template <int N>
auto of_size(const BoundedMatrix& P) {
  return Eigen::Map<const StateMatrix<N>>(P.data(), P.rows(), P.cols());
}
template <typename Sized, typename Bounded>
void store(const Sized& from, Bounded& to) {
  to.resize(from.rows(), from.cols());
  Eigen::Map<typename Sized::PlainObject>(to.data(), from.rows(), from.cols()) = from;
}

// What was measured and when, and nothing of what a tracker predicted, innovated or gained: the slot is one of
// corrected records, whose blocks of that kind nobody fills.
void begin_record(const StepRecord& step, StepRecord& corrected) {
  corrected.track = step.track;
  corrected.time_s = step.time_s;
  corrected.status = step.status;
  corrected.space = step.space;
  corrected.sensor = step.sensor;
  corrected.source = step.source;
  corrected.correction.emplace(Unfilled());
}

// States of the plane, which most corrections are of, have kernels of their own: the same numbers in SIMD instructions.
template <typename Vector>
inline constexpr bool kIsOfPlane = Vector::SizeAtCompileTime == 4;

constexpr double kLeastShare = 1e-9;  // of its variance that a pivot is, where a covariance is far from singular
constexpr double kLargest = 1e100;    // whose square is a number

// True where P (lower half) is a covariance. One that is far from singular is seen at once: every pivot is a good part
// of its variance.
template <typename Matrix>
bool is_covariance_of_state(const Matrix& P) {
  typename Matrix::PlainObject W = P;
  const Eigen::Index n = P.rows();
  bool definite = true;
#pragma GCC unroll 8
  for (Eigen::Index k = 0; k < n; ++k) {
    definite &= W(k, k) > kLeastShare * P(k, k);
    definite &= P(k, k) < kLargest;
    const double inverse = 1.0 / W(k, k);
#pragma GCC unroll 8
    for (Eigen::Index j = k + 1; j < n; ++j) {
      const double factor = W(j, k) * inverse;
#pragma GCC unroll 8
      for (Eigen::Index i = j; i < n; ++i) W(i, j) -= factor * W(i, k);
    }
  }
  return definite || is_covariance(P);
}

// The correction's own covariance P_c, of that of its source.
template <typename Matrix>
void own_covariance(const OutputUnits& units, const NetworkAnswer& answer, const BoundedMatrix& P_source, Matrix& P_c) {
  constexpr int kStates = Matrix::RowsAtCompileTime;
  if constexpr (kIsOfPlane<StateVector<kStates>>)
    if (answer.moments.size() > 0)
      return kernels::plane_own_covariance(P_source.data(), answer.moments.data(), units.rotation().axis(), P_c.data());
  P_c = of_size<kStates>(P_source);
  units.own_covariance(answer, P_c);
}

template <typename Vector, typename Matrix>
double disagreement_of(const Vector& d, const Matrix& P_c, const BoundedMatrix& P_reference) {
  if constexpr (kIsOfPlane<Vector>) {
    double squared = 0.0;
    kernels::plane_squared_distance(P_c.data(), P_reference.data(), d.data(), squared);
    return std::sqrt(squared);
  } else {
    return disagreement(d, P_c, of_size<Vector::SizeAtCompileTime>(P_reference));
  }
}

// What the weights g of what a correction says make of the covariances: a and b are the roots of g_i g_j and (1 - g_i)
// (1 - g_j), of positions (0) and velocities (1).
struct Blend {
  double a[2][2];
  double b[2][2];

  Blend(double position, double velocity) {
    const double g[2] = {position, velocity};
    for (int i = 0; i < 2; ++i) {
      a[i][i] = g[i];
      b[i][i] = 1.0 - g[i];
    }
    const bool same = position == velocity;
    a[0][1] = a[1][0] = same ? position : std::sqrt(position * velocity);
    b[0][1] = b[1][0] = same ? 1.0 - position : std::sqrt((1.0 - position) * (1.0 - velocity));
  }

  // Written as a change of P_reference: nothing to correct leaves the covariance as it is, to the bit. Lower halves are
  // read. False where the result P is no covariance.
  template <typename SomeMatrix, typename OtherMatrix, typename Vector, typename Matrix>
  bool covariance(const SomeMatrix& P_c, const OtherMatrix& P_reference, const Vector& d, Matrix& P) const {
    const Eigen::Index n = d.size(), positions = n / 2;
    P.resize(n, n);
    if constexpr (kIsOfPlane<Vector>) {
      bool definite = false;
      kernels::plane_blend(P_c.data(), P_reference.data(), d.data(), a[0], b[0], kLeastShare, kLargest, P.data(),
                           definite);
      return definite || is_covariance(P);
    }
#pragma GCC unroll 8
    for (Eigen::Index j = 0; j < n; ++j)
#pragma GCC unroll 8
      for (Eigen::Index i = j; i < n; ++i) {
        const double a_ij = a[i >= positions][j >= positions], b_ij = b[i >= positions][j >= positions];
        const double c = P_c(i, j), reference = P_reference(i, j);
        P(i, j) = P(j, i) =
            reference + a_ij * (c - reference) - (1.0 - a_ij - b_ij) * reference + a_ij * b_ij * d[i] * d[j];
      }
    return is_covariance_of_state(P);
  }
};

// Of the components of a state: g, times the weights of its positions and velocities.
struct ComponentWeights {
  double position;
  double velocity;

  ComponentWeights(double g, const Referee::Weights& w) : position(g * w.position), velocity(g * w.velocity) {}

  template <typename Vector>
  Vector times(const Vector& d) const {
    Vector weighted = d;
    for (Eigen::Index i = 0; i < d.size(); ++i) weighted[i] *= i < d.size() / 2 ? position : velocity;
    return weighted;
  }
  double mean(Eigen::Index n) const {
    if (position == velocity) return position;
    const auto positions = static_cast<double>(n / 2), components = static_cast<double>(n);
    return (positions * position + (components - positions) * velocity) / components;
  }
};

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
      begin_record(references[i], records_[i]);
      records_[i].x = references[i].x;
      records_[i].P = references[i].P;
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

// The reference, or the fallback where that lately agreed better with the measurements: what lies between them by the
// referee's weights.
const StepRecord& Correction::trusted(const StepRecord& base, const StepRecord& reference, const StepRecord* fallback,
                                      Track& track) {
  if (!fallback || fallback->status != reference.status || base.status != reference.status) return reference;
  track.handover.judge(base, *bounds_.referee);
  const BoundedVector d = reference.x - fallback->x;
  const ComponentWeights G(1.0, track.handover.weights(*bounds_.referee));
  const BoundedVector x = fallback->x + G.times(d);
  const bool valid = Blend(G.position, G.velocity).covariance(reference.P, fallback->P, d, trusted_.P);
  if (!x.allFinite() || !valid) return reference;
  handed_over_ = 1.0 - G.mean(d.size());
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
  begin_record(base, corrected);
  corrected.correction->handed_over = handed_over_;
  with_state_size(base.x.size(), [&]<int N>(std::integral_constant<int, N>) {
    store(of_size<N>(base.x), corrected.correction->base_x);
    store(of_size<N>(base.P), corrected.correction->base_P);
    const bool asked = features_.allFinite() && step.agree();
    if (asked && correct_state<N>(step, track, corrected, account)) return;
    corrected.x = step.reference->x;  // g = 0
    corrected.P = step.reference->P;
  });
}

// Of a state of N components. False where nothing is published: numbers of any size may overflow or cancel.
template <int N>
bool Correction::correct_state(const CorrectionInputs::Records& step, Track& track, StepRecord& corrected,
                               CorrectionAccount& account) {
  using Vector = StateVector<N>;
  using Matrix = StateMatrix<N>;
  const StepRecord& base = *step.base;
  const StepRecord& reference = *step.reference;
  const Vector x_base = of_size<N>(base.x), x_reference = of_size<N>(reference.x);
  const auto P_reference = of_size<N>(reference.P);
  // What does not wait for the network comes before it.
  const SafeDistance distance(reference.P);
  account.referee = bounds_.referee ? track.referee.weights(*bounds_.referee) : Referee::Weights{};

  // What it remembers are the steps that used a measurement: one that used none leaves no trace.
  const bool used = base.status == StepStatus::ok;
  if (!used) memory_ = track.memory;
  answer(model_->network, features_, used ? track.memory : memory_, answer_);

  const OutputUnits units = inputs_.units(track.extractor, base);
  Vector wanted = of_size<N>(answer_.y);
  units.to_state(wanted);
  wanted = x_base + wanted - x_reference;
  Matrix P_c;
  own_covariance(units, answer_, step.source->P, P_c);

  const auto limited = limit_kappa<N>(distance, wanted, bounds_.kappa);
  const Vector& d = limited.d;
  account.features = features_;
  account.intervals = track.extractor.intervals();
  account.disagreement = gate_ ? disagreement_of(wanted, P_c, reference.P) : 0.0;
  account.box = gate_ ? gate_->weight(features_, account.intervals, account.disagreement) : 1.0;
  account.wanted_sigmas = limited.wanted_sigmas;
  const ComponentWeights G(account.box, account.referee);

  // Where its parts have weights of their own, a correction may become longer than it was.
  const bool apart = G.position != G.velocity;
  LimitedVector<Vector> weighted;
  if (apart) {
    weighted = limit_kappa<N>(distance, G.times(d), bounds_.kappa);
    if (weighted.limited || bounds_.kappa == kInfinity) weighted.distance_sigmas = distance.of<N>(weighted.d);
  } else {
    weighted.d = G.position * d;
    weighted.distance_sigmas = G.position * limited.distance_sigmas;
  }
  const Vector x = within_kappa<N>(x_reference, distance, weighted.d, bounds_.kappa);
  if (bounds_.referee && used) track.referee.remember(base, x_reference + d, reference, x);

  corrected.P.resize(x.size(), x.size());
  Eigen::Map<Matrix> P(corrected.P.data(), x.size(), x.size());
  const bool valid = Blend(G.position, G.velocity).covariance(P_c, P_reference, d, P);
  if (!x.allFinite() || !valid) return false;
  store(x, corrected.x);
  CorrectionOutcome& outcome = *corrected.correction;
  outcome.gate = G.mean(x.size());
  outcome.limited = limited.limited;
  outcome.distance_sigmas = weighted.distance_sigmas;
  return true;
}

}  // namespace truebearing
