// SPDX-License-Identifier: Apache-2.0
#include "truebearing/filter/filter_kinds.hpp"

namespace truebearing {

TRUEBEARING_EACH_LENGTH(template class, TRUEBEARING_CONVENTIONAL_STATE);

}  // namespace truebearing
