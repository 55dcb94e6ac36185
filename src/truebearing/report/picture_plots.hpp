// SPDX-License-Identifier: Apache-2.0
// One run or log as it happened, as a plot: in the plane with bearing lines and ellipses, or a value over time.
#pragma once

#include <functional>
#include <string>

#include "truebearing/report/plot.hpp"
#include "truebearing/report/results.hpp"

namespace truebearing {

/// The picture with its times counted from the first, where they are too long for an axis.
ResultPicture on_clock(ResultPicture picture);

/// Series and axes; id, title and caption are the caller's. look_of_tracker: by its name.
Plot drawn_picture(const ResultPicture& picture, const std::function<Look(const std::string&)>& look_of_tracker);

}  // namespace truebearing
