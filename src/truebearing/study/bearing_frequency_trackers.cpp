#include "truebearing/filter/kalman.hpp"
#include "truebearing/filter/modified_gain.hpp"
#include "truebearing/filter/unscented.hpp"
#include "truebearing/study/bearing_frequency_configuration.hpp"

namespace truebearing {
namespace {

std::variant<FrequencyMotion, AcceleratingFrequencyMotion> read_motion(TableReader& tracker) {
  TableReader table = tracker.table("motion");
  const PlaneMotion motion = read_plane_motion(table);
  table.finish();
  return with_frequency(motion, tracker);
}

// Filter: by the number of states.
template <template <int> typename Filter>
std::unique_ptr<Tracker> make(TableReader& table) {
  const StateSpace& space = read_frequency_space(table);
  const auto motion = read_motion(table);
  const BearingFrequencySensor sensor = read_bearing_frequency_sensor(table);
  return std::visit(
      [&](const auto& chosen) {
        using Motion = std::decay_t<decltype(chosen)>;
        return bearing_tracker<Filter<Motion::kStates>>(table, space, chosen, sensor);
      },
      motion);
}

template <int N>
using Extended = KalmanFilter<N>;
template <int N>
using Unscented = UnscentedKalmanFilter<N>;
template <int N>
using ModifiedGain = ModifiedGainFilter<N>;

}  // namespace

std::unique_ptr<Tracker> make_frequency_kalman(TableReader& table) {
  table.choice_or("form", {"joseph"}, "joseph");
  return make<Extended>(table);
}

std::unique_ptr<Tracker> make_frequency_unscented(TableReader& table) {
  return make<Unscented>(table);
}

std::unique_ptr<Tracker> make_frequency_modified_gain(TableReader& table) {
  return make<ModifiedGain>(table);
}

}  // namespace truebearing
