// SPDX-License-Identifier: Apache-2.0
#include "truebearing/filter/filter_kinds.hpp"

namespace truebearing {

TRUEBEARING_EACH_LENGTH(template class, TRUEBEARING_UNSCENTED_STATE);
TRUEBEARING_EACH_LENGTH(template class, TRUEBEARING_UNSCENTED_GROUP);

}  // namespace truebearing
