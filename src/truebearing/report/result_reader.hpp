// SPDX-License-Identifier: Apache-2.0
// A place in a JSON file that is read: says where it is when something there is missing or of the wrong type.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "truebearing/core/constants.hpp"
#include "truebearing/core/error.hpp"

namespace truebearing {

class ResultReader {
 public:
  using Json = nlohmann::ordered_json;

  ResultReader(const Json& json, std::string file, std::string path = {})
      : json_(json), file_(std::move(file)), path_(std::move(path)) {}

  bool has(const char* key) const { return json_.is_object() && json_.contains(key); }
  InputError error(const std::string& found) const {
    return {path_.empty() ? file_ : file_ + ": " + path_, found, "results that `truebearing compare --json` wrote"};
  }

  ResultReader at(const std::string& key) const {
    if (!json_.is_object() || !json_.contains(key)) throw error("has no \"" + key + "\"");
    return {json_.at(key), file_, path_.empty() ? key : path_ + "." + key};
  }

  /// What it holds, with its key; null is nothing.
  std::vector<std::pair<std::string, ResultReader>> entries() const {
    if (json_.is_null()) return {};
    if (!json_.is_object()) throw error("is no object");
    std::vector<std::pair<std::string, ResultReader>> all;
    for (const auto& [key, value] : json_.items()) all.emplace_back(key, at(key));
    return all;
  }

  std::vector<ResultReader> items() const {
    if (!json_.is_array()) throw error("is no array");
    std::vector<ResultReader> all;
    for (std::size_t i = 0; i < json_.size(); ++i)
      all.push_back({json_.at(i), file_, path_ + "[" + std::to_string(i) + "]"});
    return all;
  }

  bool is_number() const { return json_.is_number() || json_.is_null(); }
  /// null is NaN.
  double number() const {
    if (json_.is_null()) return kNaN;
    if (!json_.is_number()) throw error("is no number");
    return json_.get<double>();
  }
  bool truth() const {
    if (!json_.is_boolean()) throw error("is neither true nor false");
    return json_.get<bool>();
  }
  std::string text() const {
    if (!json_.is_string()) throw error("is no text");
    return json_.get<std::string>();
  }
  std::vector<double> numbers() const {
    if (!json_.is_array()) throw error("is no array");
    std::vector<double> values;
    values.reserve(json_.size());
    for (const Json& value : json_) {
      if (!value.is_number() && !value.is_null()) throw error("holds what is no number");
      values.push_back(value.is_null() ? kNaN : value.get<double>());
    }
    return values;
  }

  double number_or_nan(const char* key) const { return has(key) ? at(key).number() : kNaN; }
  std::vector<double> numbers_or_none(const char* key) const {
    return has(key) ? at(key).numbers() : std::vector<double>{};
  }
  std::string text_or_none(const char* key) const { return has(key) ? at(key).text() : std::string{}; }

 private:
  const Json& json_;
  std::string file_, path_;
};

}  // namespace truebearing
