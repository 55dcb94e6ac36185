// SPDX-License-Identifier: Apache-2.0
// JsonObject: one object of a JSON file, read key by key, so that what is missing, of another type or unknown is said
// with its path.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "truebearing/core/error.hpp"

namespace truebearing {

/// finish() refuses every key that nobody asked for. `file` and `path` stand in messages.
class JsonObject {
 public:
  JsonObject(const nlohmann::json& object, std::string file, std::string path);

  const nlohmann::json& at(const std::string& key);
  bool has(const std::string& key) const { return object_->contains(key); }
  std::string text(const std::string& key);
  std::vector<std::string> texts(const std::string& key, std::size_t high);
  double number(const std::string& key) { return finite(at(key), key); }
  /// A limit: null stands for none, infinity.
  double number_or_none(const std::string& key);
  Eigen::VectorXd vector(const std::string& key, Eigen::Index size);
  const nlohmann::json& array(const std::string& key, std::size_t low, std::size_t high);
  JsonObject object(const std::string& key) { return {at(key), file_, path_.empty() ? key : path_ + "." + key}; }

  void finish() const;
  InputError error(const std::string& key, const std::string& found, const std::string& valid = {}) const;
  const std::string& file() const { return file_; }

 private:
  double finite(const nlohmann::json& value, const std::string& key) const;

  const nlohmann::json* object_;
  std::string file_;
  std::string path_;
  std::vector<std::string> asked_;
};

/// The numbers of a vector, or of a matrix by columns.
template <typename Derived>
nlohmann::ordered_json array_json(const Eigen::MatrixBase<Derived>& values) {
  nlohmann::ordered_json array = nlohmann::ordered_json::array();
  for (Eigen::Index i = 0; i < values.size(); ++i) array.push_back(values.derived().coeff(i));
  return array;
}

}  // namespace truebearing
