// SPDX-License-Identifier: Apache-2.0
// From a filter of a study to its smoother.
#pragma once

#include <memory>
#include <string>

#include "truebearing/study/tracker_spec.hpp"
#include "truebearing/tracker/tracker.hpp"

namespace truebearing {

/// Whether there is a smoother of it: of filters that publish their estimate as it is.
bool can_be_smoothed(const Tracker& tracker);

/// Throws InputError at `where` if there is none.
std::unique_ptr<Tracker> make_smoother(std::unique_ptr<Tracker> filter, const SmootherSpec& spec,
                                       const std::string& where);

}  // namespace truebearing
