// SPDX-License-Identifier: Apache-2.0
#include "truebearing/correction/correction_inputs.hpp"

#include <string>

#include "truebearing/core/error.hpp"

namespace truebearing {

int member_index(const Ensemble& ensemble, const std::string& name, const StateSpace& space) {
  const int index = ensemble.index(name);
  if (index < 0) throw InputError("correction", "needs the tracker \"" + name + "\", which does not run beside it");
  if (ensemble.tracker(index).space() != space)
    throw InputError("correction", "the tracker \"" + name + "\" has the state " + ensemble.tracker(index).space().name,
                     "the state " + space.name);
  return index;
}

CorrectionInputs::CorrectionInputs(const CorrectionDesign& design, const StateSpace& space, const Ensemble& ensemble)
    : base_(member_index(ensemble, design.base, space)),
      reference_(member_index(ensemble, design.reference, space)),
      source_(member_index(ensemble, design.covariance_of, space)),
      output_in_sigma_(design.output_in_sigma),
      prototype_(design.features, space, design.frame, [&](const std::string& name) {
        return ensemble.tracker(name.empty() ? base_ : member_index(ensemble, name, space)).blocks();
      }) {
  for (const std::string& name : prototype_.companions()) companions_.push_back(member_index(ensemble, name, space));
  companion_records_.resize(companions_.size());
}

CorrectionInputs::Records CorrectionInputs::records(const Ensemble& ensemble, int track) const {
  return {ensemble.record(base_, track), ensemble.record(reference_, track), ensemble.record(source_, track)};
}

void CorrectionInputs::extract(const Ensemble& ensemble, const StepRecord& base, FeatureExtractor& extractor,
                               Features& features) {
  for (std::size_t c = 0; c < companions_.size(); ++c)
    companion_records_[c] = ensemble.record(companions_[c], base.track);
  extractor.extract(base, companion_records_, features);
}

}  // namespace truebearing
