// SPDX-License-Identifier: Apache-2.0
// The filters that stand behind the seam of tracked_state.hpp, made by their kind and the length of a motion's state: 2
// to 7 components, or 9. Each is compiled once (*_states.cpp); a filter of one's own joins by FilterState.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "truebearing/filter/filter_group.hpp"
#include "truebearing/filter/filter_state.hpp"
#include "truebearing/filter/kalman.hpp"
#include "truebearing/filter/log_polar.hpp"
#include "truebearing/filter/modified_gain.hpp"
#include "truebearing/filter/tracked_state.hpp"
#include "truebearing/filter/unscented.hpp"
#include "truebearing/motion/any_motion.hpp"

namespace truebearing {

enum class FilterKind {
  kalman,        ///< extended where a model is nonlinear; Joseph's form
  square_root,   ///< the same, carried as a square root
  conventional,  ///< the same, P - K S K'
  unscented,
  modified_gain,  ///< in the plane
  log_polar       ///< of bearings alone, four states in the plane
};

using AnyMotions = std::vector<std::shared_ptr<const AnyMotion>>;

/// One filter under `motion`, or nothing where the kind is not compiled for states of that length.
std::unique_ptr<TrackedState> make_filter_state(FilterKind kind, const std::shared_ptr<const AnyMotion>& motion);

/// A group of filters of one kind, under motions of one length. Nothing where the kind is not compiled for it; of the
/// forms of the Kalman filter Joseph's alone is.
std::unique_ptr<FilterGroup> make_filter_group(FilterKind kind, const AnyMotions& motions,
                                               const std::vector<FilterGroup::Member>& members);

// WORDS TYPE(n) for each length of a state: on the line 2 and 3, in the plane 4 to 7, in space 6, 7 and 9.
#define TRUEBEARING_EACH_PLANE_LENGTH(WORDS, TYPE) \
  WORDS TYPE(4);                                   \
  WORDS TYPE(5);                                   \
  WORDS TYPE(6);                                   \
  WORDS TYPE(7)
#define TRUEBEARING_EACH_LENGTH(WORDS, TYPE)  \
  WORDS TYPE(2);                              \
  WORDS TYPE(3);                              \
  TRUEBEARING_EACH_PLANE_LENGTH(WORDS, TYPE); \
  WORDS TYPE(9)
#define TRUEBEARING_KALMAN_STATE(N) FilterState<KalmanFilter<N>>
#define TRUEBEARING_SQUARE_ROOT_STATE(N) FilterState<KalmanFilter<N, SquareRoot>>
#define TRUEBEARING_CONVENTIONAL_STATE(N) FilterState<KalmanFilter<N, Conventional>>
#define TRUEBEARING_UNSCENTED_STATE(N) FilterState<UnscentedKalmanFilter<N>>
#define TRUEBEARING_MODIFIED_GAIN_STATE(N) FilterState<ModifiedGainFilter<N>>
#define TRUEBEARING_KALMAN_GROUP(N) FilterGroupOf<KalmanFilter<N>>
#define TRUEBEARING_UNSCENTED_GROUP(N) FilterGroupOf<UnscentedKalmanFilter<N>>
#define TRUEBEARING_MODIFIED_GAIN_GROUP(N) FilterGroupOf<ModifiedGainFilter<N>>

TRUEBEARING_EACH_LENGTH(extern template class, TRUEBEARING_KALMAN_STATE);
TRUEBEARING_EACH_LENGTH(extern template class, TRUEBEARING_SQUARE_ROOT_STATE);
TRUEBEARING_EACH_LENGTH(extern template class, TRUEBEARING_CONVENTIONAL_STATE);
TRUEBEARING_EACH_LENGTH(extern template class, TRUEBEARING_UNSCENTED_STATE);
TRUEBEARING_EACH_PLANE_LENGTH(extern template class, TRUEBEARING_MODIFIED_GAIN_STATE);
TRUEBEARING_EACH_LENGTH(extern template class, TRUEBEARING_KALMAN_GROUP);
TRUEBEARING_EACH_LENGTH(extern template class, TRUEBEARING_UNSCENTED_GROUP);
TRUEBEARING_EACH_PLANE_LENGTH(extern template class, TRUEBEARING_MODIFIED_GAIN_GROUP);
extern template class FilterState<LogPolarFilter<>>;
extern template class FilterGroupOf<LogPolarFilter<>>;

}  // namespace truebearing
