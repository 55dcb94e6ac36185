// SPDX-License-Identifier: Apache-2.0
// toml++'s types by name: its header costs every reader a second of compiling, and most look at tables through a
// TableReader only. Who looks inside one includes <toml++/toml.h>.
#pragma once

#include <memory>

namespace toml {
inline namespace v3 {
class node;
class table;
}  // namespace v3
}  // namespace toml

namespace truebearing {

/// A table of a TOML file, and with it the whole of that file: a table inside another keeps all of it alive.
using SharedTable = std::shared_ptr<const toml::table>;

}  // namespace truebearing
