// The interacting multiple model estimator (Blom and Bar-Shalom 1988; Bar-Shalom, Li and Kirubarajan 2001, sec.
// 11.6.6): r filters under one motion model each, mixed before every prediction by the chain that says how targets
// change from one to another, weighted by the likelihood of their innovations.
//     mixing     c_j = sum_i Pi_ij mu_i,  mu_i|j = Pi_ij mu_i / c_j,
//                x_0j = sum_i mu_i|j x_i,  P_0j = sum_i mu_i|j (P_i + (x_i - x_0j)(x_i - x_0j)')
//     weighting  mu_j ~ c_j N(nu_j; 0, S_j)
// States may be of unequal length: every state is the beginning of the longest one (N). What mode i does not have and
// mode j has, an acceleration say, mode j takes from itself when it mixes: zeros from i would pull it towards no
// acceleration with a false certainty (Granstrom, Willett and Bar-Shalom 2015).
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "truebearing/core/bounded.hpp"
#include "truebearing/core/covariance.hpp"
#include "truebearing/filter/markov_chain.hpp"
#include "truebearing/filter/update.hpp"
#include "truebearing/measurement/longer_state.hpp"

namespace truebearing {

/// One way in which a target may move: a motion model and the filter that runs under it.
template <typename FilterType, typename MotionType>
struct Mode {
  using Filter = FilterType;
  MotionType motion;
};

/// The modes of a target and the chain between them: what the filter below takes for a motion model. All it holds is
/// constant.
template <typename... Modes>
struct MultipleModels {
  static constexpr int kStates = std::max({Modes::Filter::kStates...});  ///< N
  static constexpr std::size_t kMaxModes = truebearing::kMaxModes;

  std::vector<std::variant<Modes...>> modes;  ///< r, 1 to kMaxModes
  MarkovChain chain;                          ///< of r modes
};

template <typename... Modes>
class InteractingMultipleModel {
 public:
  using Models = MultipleModels<Modes...>;
  using Scalar = double;
  static constexpr int kStates = Models::kStates;
  using State = Eigen::Matrix<double, kStates, 1>;
  using Covariance = Eigen::Matrix<double, kStates, kStates>;

  /// Every mode begins with (x0, P0), or as much of it as its state has.
  InteractingMultipleModel(const State& x0, const Covariance& P0, const Models& models)
      : probabilities_(models.chain.initial), predicted_(models.chain.initial) {
    for (std::size_t j = 0; j < models.modes.size(); ++j)
      std::visit([&](const auto& mode) { begin<typename std::decay_t<decltype(mode)>::Filter>(j, x0, P0); },
                 models.modes[j]);
  }

  /// Mixes, then crosses dt_s seconds in every mode. `failed` leaves all as it was.
  StepStatus predict(const Models& models, double dt_s) {
    const ModeMatrix Pi = models.chain.over(dt_s);
    const ModeVector c = Pi.transpose() * probabilities_;
    std::array<AnyFilter, kMaxModes> mixed = filters_;
    for (Eigen::Index j = 0; j < size(); ++j) {
      ModeVector weights = Pi.col(j).cwiseProduct(probabilities_);
      if (c[j] > 0.0)
        weights /= c[j];
      else
        weights = ModeVector::Unit(size(), j);  // a mode that cannot be entered keeps to itself
      const StepStatus status =
          std::visit([&](auto& filter, const auto& mode) { return mix_and_predict(weights, filter, mode, dt_s); },
                     mixed[static_cast<std::size_t>(j)], models.modes[static_cast<std::size_t>(j)]);
      if (status == StepStatus::failed) return StepStatus::failed;
    }
    filters_ = mixed;
    predicted_ = probabilities_ = c;
    return StepStatus::ok;
  }

  /// Takes one measurement z (m) of a state that is the beginning of every mode's. nu and S are those of the mixture of
  /// the modes' predictions, K the probability-weighted gain of the modes. A mode whose arithmetic fails, where others'
  /// does not, has lost; `failed` where all have, and leaves all as it was.
  template <typename Model>
  Update<kStates, Model::kMeasurements> update(const Model& model,
                                               const Eigen::Matrix<double, Model::kMeasurements, 1>& z) {
    constexpr int M = Model::kMeasurements;
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    std::array<Update<kStates, M>, kMaxModes> updates;
    std::array<AnyFilter, kMaxModes> updated = filters_;
    ModeVector log_weight(size());
    for (Eigen::Index j = 0; j < size(); ++j) {
      auto& update = updates[static_cast<std::size_t>(j)];
      std::visit(
          [&](auto& filter) {
            constexpr int n = std::decay_t<decltype(filter)>::kStates;
            update = lifted(filter.update(on_state<n>(model), z));
          },
          updated[static_cast<std::size_t>(j)]);
      const double likelihood = log_density(update.S, update.nu);
      const bool valid = update.status == StepStatus::ok && std::isfinite(likelihood);
      log_weight[j] = valid ? std::log(predicted_[j]) + likelihood : -kInfinity;
    }
    Update<kStates, M> combined = mixture<M>(updates, log_weight);
    const double largest = log_weight.maxCoeff();
    if (!(largest > -kInfinity) || !std::isfinite(combined.nis)) {
      combined.status = StepStatus::failed;
      return combined;
    }
    filters_ = updated;
    probabilities_ = (log_weight.array() - largest).exp();
    probabilities_ /= probabilities_.sum();
    predicted_ = probabilities_;
    for (Eigen::Index j = 0; j < size(); ++j)
      if (probabilities_[j] > 0.0) combined.K += probabilities_[j] * updates[static_cast<std::size_t>(j)].K;
    combined.status = StepStatus::ok;
    return combined;
  }

  /// Mean and covariance of the mixture. What a mode's state lacks is zero in it.
  State x() const {
    State mean = State::Zero();
    for_each_mode([&](Eigen::Index j, const auto& filter) {
      mean.template head<std::decay_t<decltype(filter)>::kStates>() += probabilities_[j] * filter.x();
    });
    return mean;
  }
  Covariance P() const {
    const State mean = x();
    Covariance total = Covariance::Zero();
    for_each_mode([&](Eigen::Index j, const auto& filter) {
      constexpr int n = std::decay_t<decltype(filter)>::kStates;
      State d = -mean;
      d.template head<n>() += filter.x();
      total += probabilities_[j] * d * d.transpose();
      total.template topLeftCorner<n, n>() += probabilities_[j] * filter.P();
    });
    return total;
  }
  /// mu (r)
  const ModeVector& mode_probabilities() const { return probabilities_; }

 private:
  static constexpr std::size_t kMaxModes = Models::kMaxModes;

  // std::variant wants a first alternative that can be made from nothing; and each filter type once.
  template <typename Variant, typename... Rest>
  struct Unique {
    using Type = Variant;
  };
  template <typename... Have, typename Next, typename... Rest>
  struct Unique<std::variant<Have...>, Next, Rest...>
      : std::conditional_t<(std::is_same_v<Have, Next> || ...), Unique<std::variant<Have...>, Rest...>,
                           Unique<std::variant<Have..., Next>, Rest...>> {};
  using Filters = typename Unique<std::variant<>, typename Modes::Filter...>::Type;
  using First = std::variant_alternative_t<0, Filters>;
  using AnyFilter = Filters;

  Eigen::Index size() const { return probabilities_.size(); }

  template <typename Filter>
  void begin(std::size_t j, const State& x0, const Covariance& P0) {
    constexpr int n = Filter::kStates;
    filters_[j] = Filter(x0.template head<n>(), P0.template topLeftCorner<n, n>());
  }

  static AnyFilter nothing() { return First(First::State::Zero(), First::Covariance::Identity()); }
  template <std::size_t... I>
  static std::array<AnyFilter, sizeof...(I)> nothings(std::index_sequence<I...>) {
    return {((void)I, nothing())...};
  }

  template <typename Visit>
  void for_each_mode(const Visit& visit) const {
    for (Eigen::Index j = 0; j < size(); ++j)
      std::visit([&](const auto& filter) { visit(j, filter); }, filters_[static_cast<std::size_t>(j)]);
  }

  // Equations (11.6.6-8) to (-10): `filter` is mode j's own before, mixed and predicted after.
  template <typename Filter, typename ModeType>
  StepStatus mix_and_predict(const ModeVector& weights, Filter& filter, const ModeType& mode, double dt_s) const {
    if constexpr (!std::is_same_v<Filter, typename ModeType::Filter>) {
      return StepStatus::failed;  // modes and filters are made in the same order: this cannot be
    } else {
      using Vector = typename Filter::State;
      using Matrix = typename Filter::Covariance;
      const Vector own_x = filter.x();
      const Matrix own_P = filter.P();
      Vector mean = Vector::Zero();
      for_each_mode([&](Eigen::Index i, const auto& other) { mean += weights[i] * state_in(own_x, other); });
      Matrix P = Matrix::Zero();
      for_each_mode([&](Eigen::Index i, const auto& other) {
        if (weights[i] == 0.0) return;
        const Vector d = state_in(own_x, other) - mean;
        P += weights[i] * (covariance_in(own_P, other) + d * d.transpose());
      });
      filter = Filter(mean, P);
      return filter.predict(mode.motion, dt_s);
    }
  }

  // The other mode's estimate in a space of n states; what it lacks is taken from the space's own.
  template <int n, typename Other>
  static Eigen::Matrix<double, n, 1> state_in(const Eigen::Matrix<double, n, 1>& own, const Other& other) {
    constexpr int shared = std::min(n, Other::kStates);
    Eigen::Matrix<double, n, 1> x = own;
    x.template head<shared>() = other.x().template head<shared>();
    return x;
  }
  template <int n, typename Other>
  static Eigen::Matrix<double, n, n> covariance_in(const Eigen::Matrix<double, n, n>& own, const Other& other) {
    constexpr int shared = std::min(n, Other::kStates);
    Eigen::Matrix<double, n, n> P = own;
    P.template leftCols<shared>().setZero();
    P.template topRows<shared>().setZero();
    P.template topLeftCorner<shared, shared>() = other.P().template topLeftCorner<shared, shared>();
    return P;
  }

  template <int n, int M>
  static Update<kStates, M> lifted(const Update<n, M>& update) {
    if constexpr (n == kStates) {
      return update;
    } else {
      Update<kStates, M> longer{update.nu, update.S, Eigen::Matrix<double, kStates, M>::Zero(), update.nis,
                                update.status};
      longer.K.template topRows<n>() = update.K;
      return longer;
    }
  }

  // nu, S and NIS of the mixture of the predictions of the modes that have not failed.
  template <int M>
  Update<kStates, M> mixture(const std::array<Update<kStates, M>, kMaxModes>& updates,
                             const ModeVector& log_weight) const {
    Update<kStates, M> combined;
    combined.nu.setZero();
    combined.S.setZero();
    combined.K.setZero();
    double total = 0.0;
    const auto each = [&](const auto& use) {
      for (Eigen::Index j = 0; j < size(); ++j)
        if (std::isfinite(log_weight[j])) use(predicted_[j], updates[static_cast<std::size_t>(j)]);
    };
    each([&](double c, const auto& update) {
      total += c;
      combined.nu += c * update.nu;
    });
    combined.nu /= total;
    each([&](double c, const auto& update) {
      const Eigen::Matrix<double, M, 1> d = update.nu - combined.nu;
      combined.S += c / total * (update.S + d * d.transpose());
    });
    combined.nis = mahalanobis_squared(combined.S, combined.nu);
    return combined;
  }

  std::array<AnyFilter, kMaxModes> filters_ = nothings(std::make_index_sequence<kMaxModes>{});
  ModeVector probabilities_;  // mu
  ModeVector predicted_;      // c of the last prediction
};

}  // namespace truebearing
