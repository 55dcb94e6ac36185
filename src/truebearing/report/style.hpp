// SPDX-License-Identifier: Apache-2.0
// How pages and plots look. Colours are told apart by the colour-blind (after Okabe and Ito 2008, darkened on white and
// lightened on black to a contrast of 3), and lines by their dashes too.
#pragma once

#include <string>

namespace truebearing {

/// Of a plot, in its file or on its page.
const std::string& plot_style();
/// Of a page, with that of its plots.
const std::string& page_style();

}  // namespace truebearing
