// SPDX-License-Identifier: Apache-2.0
// What pages are put together from: the frame with its policy, sections of plots, what stands folded.
#pragma once

#include <string>
#include <vector>

#include "truebearing/report/plot.hpp"

namespace truebearing {

/// A whole page around `body`, which is markup. Its policy allows its own style, the script that plays what has
/// times (player.hpp), and nothing else.
std::string html_page(const std::string& title, const std::string& body);

/// Plots, each with its sentence and its numbers; empty where there are none.
std::string figures_markup(const std::vector<Plot>& plots);

/// "<h2>Title</h2>" and the end of its line; level: of the heading.
std::string heading(const std::string& title, int level = 2);

/// Plots under a heading; empty where there are none.
std::string section(const std::string& title, const std::vector<Plot>& plots, int level = 2);

/// Markup that unfolds; empty where there is none.
std::string folded(const std::string& title, const std::string& markup);

}  // namespace truebearing
