// SPDX-License-Identifier: Apache-2.0
#include "truebearing/core/random.hpp"

#include <Random123/philox.h>
#include <utility>

#include "truebearing/core/random_source.hpp"

namespace truebearing {
namespace {

thread_local RandomSource* random_source = nullptr;

}  // namespace

TakeRandomFrom::TakeRandomFrom(RandomSource& source) : before_(std::exchange(random_source, &source)) {}

TakeRandomFrom::~TakeRandomFrom() {
  random_source = before_;
}

void RandomStream::refill() {
  const r123::Philox4x64::key_type key{{key_[0], key_[1]}};
  const r123::Philox4x64::ctr_type counter{{counter_[0], counter_[1], counter_[2], counter_[3]}};
  const r123::Philox4x64::ctr_type block = r123::Philox4x64()(counter, key);
  block_ = {block[0], block[1], block[2], block[3]};
  has_source_ = random_source != nullptr;
  if (RandomSource* const source = random_source) {
    random_source = nullptr;  // the source may draw from streams of its own
    block_ = source->block({key_, counter_[1]}, counter_[0], block_);
    random_source = source;
  }
  ++counter_[0];
  next_ = 0;
}

void RandomStream::tell_of_normals() {
  if (random_source) random_source->normals({key_, counter_[1]}, (counter_[0] - 1) * block_.size() + next_);
}

}  // namespace truebearing
