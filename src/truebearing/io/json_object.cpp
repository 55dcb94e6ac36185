// SPDX-License-Identifier: Apache-2.0
#include "truebearing/io/json_object.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <utility>

#include "truebearing/core/suggestion.hpp"

namespace truebearing {

JsonObject::JsonObject(const nlohmann::json& object, std::string file, std::string path)
    : object_(&object), file_(std::move(file)), path_(std::move(path)) {
  if (!object.is_object()) throw InputError(file_ + (path_.empty() ? "" : ": " + path_), "is no object", "{ ... }");
}

const nlohmann::json& JsonObject::at(const std::string& key) {
  asked_.push_back(key);
  const auto found = object_->find(key);
  if (found == object_->end()) throw error(key, "is missing");
  return *found;
}

std::string JsonObject::text(const std::string& key) {
  const nlohmann::json& value = at(key);
  if (!value.is_string()) throw error(key, "is no text", "text in quotes");
  return value.get<std::string>();
}

std::vector<std::string> JsonObject::texts(const std::string& key, std::size_t high) {
  std::vector<std::string> texts;
  for (const nlohmann::json& value : array(key, 1, high)) {
    if (!value.is_string()) throw error(key, "holds " + value.dump().substr(0, 40), "texts");
    texts.push_back(value.get<std::string>());
  }
  return texts;
}

double JsonObject::number_or_none(const std::string& key) {
  return at(key).is_null() ? std::numeric_limits<double>::infinity() : number(key);
}

Eigen::VectorXd JsonObject::vector(const std::string& key, Eigen::Index size) {
  const nlohmann::json& value = at(key);
  if (!value.is_array() || value.size() != static_cast<std::size_t>(size))
    throw error(key, value.is_array() ? fmt::format("holds {} values", value.size()) : "is no array",
                fmt::format("an array of {} numbers", size));
  Eigen::VectorXd numbers(size);
  for (Eigen::Index i = 0; i < size; ++i) numbers[i] = finite(value[static_cast<std::size_t>(i)], key);
  return numbers;
}

const nlohmann::json& JsonObject::array(const std::string& key, std::size_t low, std::size_t high) {
  const nlohmann::json& value = at(key);
  if (!value.is_array() || value.size() < low || value.size() > high)
    throw error(key, value.is_array() ? fmt::format("holds {} values", value.size()) : "is no array",
                fmt::format("an array of {} to {}", low, high));
  return value;
}

void JsonObject::finish() const {
  for (const auto& [key, value] : object_->items())
    if (std::find(asked_.begin(), asked_.end(), key) == asked_.end())
      throw error(key, "is not a known key", suggestion(key, asked_));
}

InputError JsonObject::error(const std::string& key, const std::string& found, const std::string& valid) const {
  return {file_ + ": " + (path_.empty() ? key : path_ + "." + key), found, valid};
}

double JsonObject::finite(const nlohmann::json& value, const std::string& key) const {
  if (!value.is_number() || !std::isfinite(value.get<double>()))
    throw error(key, "holds " + value.dump().substr(0, 40), "finite numbers");
  return value.get<double>();
}

}  // namespace truebearing
