// The modes of a multiple-model tracker and the chain between them, from its table in a study.
#pragma once

#include <vector>

#include "truebearing/filter/markov_chain.hpp"
#include "truebearing/study/filter_configuration.hpp"

namespace truebearing {

/// [[modes]]: motions, one each, or with turn_rates_degps one for each rate; 2 to kMaxModes of them.
std::vector<PlaneMotion> read_modes(TableReader& tracker);

/// transition = { matrix = [...], period_s } row by row, or { leave_first, leave_other, to_first, period_s }; initial.
MarkovChain read_chain(TableReader& tracker, int modes);

}  // namespace truebearing
