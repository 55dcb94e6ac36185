// SPDX-License-Identifier: Apache-2.0
#include "truebearing/filter/filter_kinds.hpp"

#include <type_traits>
#include <utility>

#include "truebearing/core/with_count.hpp"

namespace truebearing {
namespace {

template <int N>
using Extended = KalmanFilter<N>;
template <int N>
using ExtendedSquareRoot = KalmanFilter<N, SquareRoot>;
template <int N>
using ExtendedConventional = KalmanFilter<N, Conventional>;
template <int N>
using Unscented = UnscentedKalmanFilter<N>;
template <int N>
using ModifiedGain = ModifiedGainFilter<N>;

// make(std::integral_constant<int, states>()), nullptr where nothing is compiled for that many.
template <int kLeast, int kMost, typename Made, typename Make>
std::unique_ptr<Made> by_length(int states, const Make& make) {
  std::unique_ptr<Made> made;
  with_count(states, [&]<int N>(std::integral_constant<int, N> n) {
    if constexpr (N >= kLeast && N <= kMost && N != 8) made = make(n);
  });
  return made;
}

template <typename Filter>
std::unique_ptr<TrackedState> one(const std::shared_ptr<const AnyMotion>& motion) {
  return std::make_unique<FilterState<Filter>>(std::static_pointer_cast<const SizedMotion<Filter::kStates>>(motion));
}

template <template <int> typename Filter, int kLeast = 2, int kMost = 9>
std::unique_ptr<TrackedState> state(const std::shared_ptr<const AnyMotion>& motion) {
  return by_length<kLeast, kMost, TrackedState>(
      motion->states(), [&]<int N>(std::integral_constant<int, N>) { return one<Filter<N>>(motion); });
}

template <typename Filter>
std::unique_ptr<FilterGroup> several(const AnyMotions& motions, const std::vector<FilterGroup::Member>& members) {
  std::vector<std::shared_ptr<const SizedMotion<Filter::kStates>>> sized;
  for (const auto& motion : motions)
    sized.push_back(std::static_pointer_cast<const SizedMotion<Filter::kStates>>(motion));
  return std::make_unique<FilterGroupOf<Filter>>(std::move(sized), members);
}

template <template <int> typename Filter, int kLeast = 2, int kMost = 9>
std::unique_ptr<FilterGroup> group(const AnyMotions& motions, const std::vector<FilterGroup::Member>& members) {
  return by_length<kLeast, kMost, FilterGroup>(motions.front()->states(), [&]<int N>(std::integral_constant<int, N>) {
    return several<Filter<N>>(motions, members);
  });
}

}  // namespace

std::unique_ptr<TrackedState> make_filter_state(FilterKind kind, const std::shared_ptr<const AnyMotion>& motion) {
  switch (kind) {
    case FilterKind::kalman:
      return state<Extended>(motion);
    case FilterKind::square_root:
      return state<ExtendedSquareRoot>(motion);
    case FilterKind::conventional:
      return state<ExtendedConventional>(motion);
    case FilterKind::unscented:
      return state<Unscented>(motion);
    case FilterKind::modified_gain:
      return state<ModifiedGain, 4, 7>(motion);
    case FilterKind::log_polar:
      return motion->states() == 4 ? one<LogPolarFilter<>>(motion) : nullptr;
  }
  return nullptr;
}

std::unique_ptr<FilterGroup> make_filter_group(FilterKind kind, const AnyMotions& motions,
                                               const std::vector<FilterGroup::Member>& members) {
  switch (kind) {
    case FilterKind::kalman:
      return group<Extended>(motions, members);
    case FilterKind::unscented:
      return group<Unscented>(motions, members);
    case FilterKind::modified_gain:
      return group<ModifiedGain, 4, 7>(motions, members);
    case FilterKind::log_polar:
      return motions.front()->states() == 4 ? several<LogPolarFilter<>>(motions, members) : nullptr;
    case FilterKind::square_root:
    case FilterKind::conventional:
      return nullptr;
  }
  return nullptr;
}

}  // namespace truebearing
