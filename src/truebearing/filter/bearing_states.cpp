// SPDX-License-Identifier: Apache-2.0
#include "truebearing/filter/filter_kinds.hpp"

namespace truebearing {

TRUEBEARING_EACH_PLANE_LENGTH(template class, TRUEBEARING_MODIFIED_GAIN_STATE);
TRUEBEARING_EACH_PLANE_LENGTH(template class, TRUEBEARING_MODIFIED_GAIN_GROUP);
template class FilterState<LogPolarFilter<>>;
template class FilterGroupOf<LogPolarFilter<>>;

}  // namespace truebearing
