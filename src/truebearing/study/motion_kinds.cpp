// SPDX-License-Identifier: Apache-2.0
#include "truebearing/study/motion_kinds.hpp"

#include <cmath>
#include <filesystem>
#include <fmt/format.h>
#include <optional>
#include <string>
#include <toml++/toml.h>
#include <variant>
#include <vector>

#include "truebearing/core/angle.hpp"
#include "truebearing/core/with_count.hpp"
#include "truebearing/correction/learned_motion_file.hpp"
#include "truebearing/filter/erased_motion.hpp"
#include "truebearing/motion/constant_acceleration.hpp"
#include "truebearing/motion/constant_jerk.hpp"
#include "truebearing/motion/constant_velocity.hpp"
#include "truebearing/motion/coordinated_turn.hpp"
#include "truebearing/motion/singer.hpp"
#include "truebearing/motion/turning_target.hpp"
#include "truebearing/motion/with_frequency.hpp"
#include "truebearing/motion/with_vertical.hpp"
#include "truebearing/simulation/lorenz_scenario.hpp"
#include "truebearing/study/learned_motion_spec.hpp"

namespace truebearing {
namespace {

constexpr Range kTurnRate_degps{-90.0, 90.0};

// `model` of a target in D dimensions; with the frequency where the layout has it, which is in the plane.
template <int D, typename Model>
std::shared_ptr<const AnyMotion> laid_out(const Model& model, const MotionLayout& layout, std::string_view rest = {}) {
  if constexpr (D == 2)
    if (layout.has_frequency) return erased(WithFrequency<Model>{model, layout.frequency_q_hz2ps}, rest);
  return erased(model, rest);
}

// noise = "fixed" | "discrete" | "continuous" and its number.
template <int D>
AnyNoise<2 * D> read_noise(TableReader& motion, double factor) {
  const std::string kind = motion.choice("noise", {"fixed", "discrete", "continuous"});
  if (kind == "discrete") return {DiscreteWhiteNoise{motion.number("sigma_a_mps2", kNonNegative) * std::sqrt(factor)}};
  if (kind == "continuous") return {ContinuousWhiteNoise{motion.number("q_m2ps3", kNonNegative) * factor}};
  const std::vector<double> variance = motion.numbers("variance", 2 * D, kNonNegative);
  const double period_s = motion.number("period_s", kPositive);
  FixedNoise<2 * D> noise{Eigen::Map<const Eigen::Matrix<double, 2 * D, 1>>(variance.data()).asDiagonal(), period_s};
  noise.Q_per_step *= factor;
  return {noise};
}

// vertical = { noise, ... }: of the vertical channel of a target in space.
AnyNoise<2> read_vertical(TableReader& motion, double factor) {
  TableReader vertical = motion.table("vertical");
  const AnyNoise<2> noise = read_noise<1>(vertical, factor);
  vertical.finish();
  return noise;
}

// `horizontal` with a vertical channel of that noise above it.
template <typename Horizontal>
std::shared_ptr<const AnyMotion> above(const Horizontal& horizontal, const AnyNoise<2>& noise,
                                       std::string_view rest = {}) {
  using Vertical = ConstantVelocity<1, AnyNoise<2>>;
  return erased(WithVertical<Horizontal, Vertical>{horizontal, Vertical{noise}}, rest);
}

template <int D>
std::shared_ptr<const AnyMotion> constant_velocity(TableReader& motion, const MotionLayout& layout) {
  if (D == 3 && motion.has("vertical")) {
    const double factor = layout.process_noise_factor;
    const ConstantVelocity<2, AnyNoise<4>> level{read_noise<2>(motion, factor)};
    return above(level, read_vertical(motion, factor));
  }
  return laid_out<D>(ConstantVelocity<D, AnyNoise<2 * D>>{read_noise<D>(motion, layout.process_noise_factor)}, layout);
}

template <int D>
std::shared_ptr<const AnyMotion> constant_acceleration(TableReader& motion, const MotionLayout& layout) {
  const double factor = layout.process_noise_factor;
  if (motion.choice("noise", {"continuous", "discrete"}) == "continuous") {
    const ContinuousWhiteJerk noise{motion.number("q_m2ps5", kNonNegative) * factor};
    return laid_out<D>(ConstantAcceleration<D, ContinuousWhiteJerk>{noise}, layout, "accelerations");
  }
  const DiscreteAccelerationStep noise{motion.number("sigma_mps2", kNonNegative) * std::sqrt(factor)};
  return laid_out<D>(ConstantAcceleration<D, DiscreteAccelerationStep>{noise}, layout, "accelerations");
}

std::shared_ptr<const AnyMotion> constant_jerk(TableReader& motion, const MotionLayout& layout) {
  const double q = motion.number("q_m2ps7", kNonNegative) * layout.process_noise_factor;
  return laid_out<1>(ConstantJerk<1>{q}, layout, "accelerations");
}

template <int D>
std::shared_ptr<const AnyMotion> singer(TableReader& motion, const MotionLayout& layout) {
  const double sigma = motion.number("sigma_a_mps2", kPositive) * std::sqrt(layout.process_noise_factor);
  return laid_out<D>(Singer<D>{sigma, motion.number("time_constant_s", kPositive)}, layout, "accelerations");
}

// The noises of turns, which are level: in space the vertical channel has one of its own.
struct TurnNoise {
  AnyNoise<4> level;
  std::optional<AnyNoise<2>> vertical;
};

TurnNoise read_turn_noise(TableReader& motion, const MotionLayout& layout) {
  TurnNoise noise{read_noise<2>(motion, layout.process_noise_factor), std::nullopt};
  if (layout.dimensions == 3) noise.vertical = read_vertical(motion, layout.process_noise_factor);
  return noise;
}

std::shared_ptr<const AnyMotion> coordinated_turn(const TurnNoise& noise, double rate_degps,
                                                  const MotionLayout& layout) {
  const CoordinatedTurn<AnyNoise<4>> turn{noise.level, radians(rate_degps)};
  return noise.vertical ? above(turn, *noise.vertical) : laid_out<2>(turn, layout);
}

std::shared_ptr<const AnyMotion> coordinated_turn(TableReader& motion, const MotionLayout& layout) {
  const double rate_degps = motion.number("turn_rate_degps", kTurnRate_degps);
  return coordinated_turn(read_turn_noise(motion, layout), rate_degps, layout);
}

std::shared_ptr<const AnyMotion> turning_target(TableReader& motion, const MotionLayout& layout) {
  const double factor = layout.process_noise_factor;
  const double wander = radians(motion.number("turn_rate_noise_degps2", kNonNegative) * std::sqrt(factor));
  const TurnNoise noise = read_turn_noise(motion, layout);
  const TurningTarget<AnyNoise<4>> turning{noise.level, wander};
  return noise.vertical ? above(turning, *noise.vertical, "turn rate") : laid_out<2>(turning, layout, "turn rate");
}

std::shared_ptr<const AnyMotion> lorenz_attractor(TableReader& motion, const MotionLayout& layout) {
  const double sigma = motion.number("sigma", kNonNegative) * std::sqrt(layout.process_noise_factor);
  return std::visit([](const auto& model) { return std::shared_ptr<const AnyMotion>(erased(model)); },
                    read_lorenz_motion(motion, sigma));
}

// Its file is made for a motion of that many components by `truebearing train`.
std::shared_ptr<const AnyMotion> learned(TableReader& motion, const MotionLayout& layout) {
  const LearnedMotionSpec spec = read_learned_motion_spec(motion);
  const std::shared_ptr<const AnyMotion> around = read_motion(motion.table("around"), layout);
  if (!std::filesystem::exists(spec.file))
    throw motion.error("file", "names " + spec.file.string() + ", which does not exist",
                       "run `truebearing train " + motion.file() + "`");
  const auto residual = std::make_shared<const MotionResidual>(read_learned_motion_file(spec.file));
  if (residual->network.inputs() != around->states())
    throw motion.error(
        "file", fmt::format("was trained for a state of {} components", residual->network.inputs()),
        fmt::format("{}, as \"around\" has; run `truebearing train {}`", around->states(), motion.file()));
  std::shared_ptr<const AnyMotion> made;
  with_count(around->states(), [&]<int N>(std::integral_constant<int, N>) {
    if constexpr (N >= 2 && N <= 9 && N != 8)  // as filters are (filter_kinds.hpp)
      made = erased(LearnedMotion<N>{std::static_pointer_cast<const SizedMotion<N>>(around), residual}, around->rest());
  });
  return made;
}

using Read = std::shared_ptr<const AnyMotion> (*)(TableReader& motion, const MotionLayout& layout);

struct MotionKind {
  const char* model;
  Read on_line;                 ///< nullptr where there is none
  Read in_plane;                ///< with a frequency or without; nullptr where there is none
  Read in_space = nullptr;      ///< nullptr where there is none
  Read on_attractor = nullptr;  ///< of Lorenz; nullptr where there is none

  Read in(const MotionLayout& layout) const {
    if (layout.is_lorenz) return on_attractor;
    return layout.dimensions == 1 ? on_line : layout.dimensions == 2 ? in_plane : in_space;
  }
};

constexpr MotionKind kKinds[] = {
    {"constant_velocity", constant_velocity<1>, constant_velocity<2>, constant_velocity<3>},
    {"coordinated_turn", nullptr, coordinated_turn, coordinated_turn},
    {"constant_acceleration", constant_acceleration<1>, constant_acceleration<2>, constant_acceleration<3>},
    {"constant_jerk", constant_jerk, nullptr},  // eight states in the plane, more than are compiled
    {"singer", singer<1>, singer<2>, singer<3>},
    {"turning_target", nullptr, turning_target, turning_target},
    {"lorenz_taylor", nullptr, nullptr, nullptr, lorenz_attractor},
    {"lorenz_rk4", nullptr, nullptr, nullptr, lorenz_attractor},
    {"learned", learned, learned, learned, learned},
};

// One table of `modes` is one mode, or with turn_rates_degps one for each rate.
void read_mode(TableReader& mode, const MotionLayout& layout, std::vector<ModeChoice>& modes) {
  const double sigma_factor = mode.number_or("sigma_factor", 1.0, kPositive);
  if (layout.is_lorenz || layout.dimensions == 1 || !mode.has("turn_rates_degps")) {
    if ((*mode.raw())["model"].value_or(std::string()) == "learned")
      throw mode.error("model", "is \"learned\", which is taught as the only motion of a tracker", "another model");
    modes.push_back({read_motion(mode, layout), sigma_factor});
    return;
  }
  mode.choice("model", {"coordinated_turn"});
  const TurnNoise noise = read_turn_noise(mode, layout);
  for (const double rate_degps : mode.numbers("turn_rates_degps", -1, kTurnRate_degps))
    modes.push_back({coordinated_turn(noise, rate_degps, layout), sigma_factor});
  mode.finish();
}

}  // namespace

std::shared_ptr<const AnyMotion> read_motion(TableReader motion, const MotionLayout& layout) {
  std::vector<std::string> models;
  for (const MotionKind& kind : kKinds)
    if (kind.in(layout)) models.emplace_back(kind.model);
  const std::string model = motion.choice("model", models);
  for (const MotionKind& kind : kKinds) {
    if (model != kind.model) continue;
    std::shared_ptr<const AnyMotion> read = kind.in(layout)(motion, layout);
    motion.finish();
    return read;
  }
  throw motion.error("model", "is \"" + model + "\"");
}

std::vector<ModeChoice> read_modes(TableReader& tracker, const MotionLayout& layout) {
  std::vector<ModeChoice> modes;
  for (TableReader& mode : tracker.tables("modes")) read_mode(mode, layout, modes);
  if (modes.size() < 2 || modes.size() > static_cast<std::size_t>(kMaxModes))
    throw tracker.error("modes", fmt::format("makes {} of them", modes.size()), fmt::format("2 to {}", kMaxModes));
  std::string_view rest;
  for (const auto& [motion, sigma_factor] : modes) {
    if (!motion->rest().empty() && !rest.empty() && motion->rest() != rest)
      throw tracker.error("modes", fmt::format("mix {} and {}, which are no parts of one state", rest, motion->rest()),
                          "one of the two beside constant velocity and coordinated turns");
    if (!motion->rest().empty()) rest = motion->rest();
  }
  return modes;
}

}  // namespace truebearing
