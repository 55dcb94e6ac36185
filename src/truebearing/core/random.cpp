// SPDX-License-Identifier: Apache-2.0
#include "truebearing/core/random.hpp"

#include <Random123/philox.h>

namespace truebearing {

void RandomStream::refill() {
  const r123::Philox4x64::key_type key{{key_[0], key_[1]}};
  const r123::Philox4x64::ctr_type counter{{counter_[0], counter_[1], counter_[2], counter_[3]}};
  const r123::Philox4x64::ctr_type block = r123::Philox4x64()(counter, key);
  block_ = {block[0], block[1], block[2], block[3]};
  ++counter_[0];
  next_ = 0;
}

}  // namespace truebearing
