// SPDX-License-Identifier: Apache-2.0
// The errors of the trackers on a log that has truth: a comparison whose runs are the log's tracks.
#pragma once

#include <string>
#include <vector>

#include "truebearing/evaluation/comparison.hpp"
#include "truebearing/evaluation/run_picture.hpp"
#include "truebearing/evaluation/tracker_set.hpp"
#include "truebearing/recording/recording.hpp"
#include "truebearing/study/study.hpp"

namespace truebearing {

struct ScoredLog {
  Comparison comparison;
  std::vector<RunPicture> pictures;  ///< where they are wanted
};

/// tracks: one or more, each with its truth. The trackers' time begins at epoch_s of the log's. log: what it is called.
/// A bound that asks for more than the log tells is left out, and that is said.
ScoredLog score_log(const Study& study, const std::string& log, const TrackerSet& trackers,
                    std::vector<Recording> tracks, double epoch_s, bool with_pictures);

}  // namespace truebearing
