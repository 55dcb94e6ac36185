// SPDX-License-Identifier: Apache-2.0
// Which states may be packed, and when that is of use.
#include "truebearing/filter/state_pack.hpp"

#include <memory>
#include <type_traits>
#include <utility>

#include "truebearing/core/with_count.hpp"
#include "truebearing/filter/filter_kinds.hpp"
#include "truebearing/filter/filter_pack.hpp"

namespace truebearing {
namespace {

template <int N>
std::unique_ptr<StatePack> filter_pack(const TrackedState& state) {
  typename FilterPack<N>::Motions motions;
  const auto add = [&](const TrackedState& mode) {
    const auto* filter = dynamic_cast<const FilterState<KalmanFilter<N>>*>(&mode);
    if (filter) motions.push_back(filter->motion());
    return filter != nullptr;
  };
  if (const auto* model = dynamic_cast<const InteractingMultipleModel*>(&state)) {
    if (model->modes().size() < 2) return nullptr;
    for (const auto& mode : model->modes())
      if (!add(*mode)) return nullptr;
    return std::make_unique<FilterPack<N>>(std::move(motions), model->chain());
  }
  if (!add(state)) return nullptr;
  return std::make_unique<FilterPack<N>>(std::move(motions), MarkovChain{});
}

// Whether a lane costs less in a pack than by itself.
bool has_long_registers() {
#if defined(__x86_64__) && defined(__GNUC__)
  return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
#else
  return false;
#endif
}

}  // namespace

std::unique_ptr<StatePack> pack_of(const TrackedState& state) {
  std::unique_ptr<StatePack> pack;
  if (!has_long_registers()) return pack;
  with_count(state.size(), [&]<int N>(std::integral_constant<int, N>) {
    if constexpr (N == 2 || N == 4 || N == 6) pack = filter_pack<N>(state);
  });
  return pack;
}

}  // namespace truebearing
