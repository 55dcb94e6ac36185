// SPDX-License-Identifier: Apache-2.0
#include "truebearing/io/json_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <exception>
#include <nlohmann/json.hpp>
#include <set>
#include <vector>

#include "truebearing/core/error.hpp"
#include "truebearing/io/file.hpp"

namespace truebearing {
namespace {

using nlohmann::json;

constexpr std::size_t kMaxShown = 160;

/// Watches the parser from outside and stops it at the first container that is too deep, or key that was there before.
template <typename Json>
class Guard {
 public:
  Guard(const std::string& name, std::size_t max_depth) : name_(name), max_depth_(max_depth) {}

  void see(typename Json::parse_event_t event, const Json& parsed) {
    switch (event) {
      case Json::parse_event_t::object_start:
      case Json::parse_event_t::array_start:
        if (keys_.size() == max_depth_)
          throw InputError(name_, "is nested too deeply", fmt::format("at most {} levels", max_depth_));
        keys_.emplace_back();
        break;
      case Json::parse_event_t::object_end:
      case Json::parse_event_t::array_end:
        keys_.pop_back();
        break;
      case Json::parse_event_t::key:
        if (!keys_.back().insert(parsed.template get<std::string>()).second)
          throw InputError(name_, "has the key " + parsed.dump().substr(0, kMaxShown) + " twice in one object");
        break;
      default:
        break;
    }
  }

 private:
  const std::string& name_;
  std::size_t max_depth_;
  std::vector<std::set<std::string>> keys_;  // of the containers that are open
};

/// The library's message without its bracketed name, which says nothing to a user.
std::string description(const std::exception& error) {
  const std::string_view text = error.what();
  const std::size_t bracket = text.find("] ");
  return std::string(text.substr(bracket == std::string_view::npos ? 0 : bracket + 2).substr(0, kMaxShown));
}

template <typename Json>
Json parse_guarded(std::string_view text, const std::string& name, JsonLimits limits) {
  if (text.size() > limits.max_bytes)
    throw InputError(name, "is too large", fmt::format("at most {} bytes", limits.max_bytes));
  Guard<Json> guard(name, limits.max_depth);
  const auto watch = [&](int, typename Json::parse_event_t event, Json& parsed) {
    guard.see(event, parsed);
    return true;
  };
  try {
    return Json::parse(text, watch);
  } catch (const typename Json::parse_error& error) {
    const std::string_view before = text.substr(0, error.byte > 0 ? error.byte - 1 : 0);
    throw InputError(fmt::format("{}:{}", name, 1 + std::count(before.begin(), before.end(), '\n')), description(error),
                     "JSON");
  } catch (const typename Json::exception& error) {
    throw InputError(name, description(error), "JSON");
  }
}

}  // namespace

json parse_json(std::string_view text, const std::string& name, JsonLimits limits) {
  return parse_guarded<json>(text, name, limits);
}

nlohmann::ordered_json parse_ordered_json(std::string_view text, const std::string& name, JsonLimits limits) {
  return parse_guarded<nlohmann::ordered_json>(text, name, limits);
}

json read_json_file(const std::filesystem::path& path, JsonLimits limits) {
  return parse_json(read_text_file(path, limits.max_bytes), path.string(), limits);
}

std::string json_text(const nlohmann::ordered_json& value) {
  return value.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

}  // namespace truebearing
