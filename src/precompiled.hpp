// SPDX-License-Identifier: Apache-2.0
// What most translation units read and no change of ours touches, compiled once for each library (CMake's precompiled
// headers). No file relies on it: each includes what it uses.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fmt/format.h>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <numbers>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>
