// SPDX-License-Identifier: Apache-2.0
#include "truebearing/simulation/distribution.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <numbers>
#include <toml++/toml.h>
#include <utility>

#include "truebearing/core/chi_square.hpp"
#include "truebearing/io/key_survey.hpp"

namespace truebearing {
namespace {

using Kind = Distribution::Kind;

struct Form {
  Kind kind;
  const char* name;
  int parameters;  // negative: any number of them
};
constexpr std::array kForms{Form{Kind::uniform, "uniform", 2}, Form{Kind::normal, "normal", 2},
                            Form{Kind::log_uniform, "log_uniform", 2}, Form{Kind::choice, "choice", -1}};
constexpr const char* kValid =
    "a number, { uniform = [low, high] }, { normal = [mean, standard deviation] }, { log_uniform = [low, high] } or "
    "{ choice = [a, b, ...] }";

/// What is wrong with the parameters; empty where nothing is.
std::string fault(Kind kind, const std::vector<double>& p) {
  switch (kind) {
    case Kind::fixed:
      return p.size() == 1 ? "" : "is not one number";
    case Kind::choice:
      return p.empty() ? "has nothing to choose from" : "";
    case Kind::normal:
      if (p.size() != 2) return "does not have a mean and a standard deviation";
      return p[1] >= 0.0 ? "" : "has a negative standard deviation";
    case Kind::uniform:
    case Kind::log_uniform:
      if (p.size() != 2 || !(p[0] <= p[1])) return "does not have a low end and a high end in this order";
      return kind == Kind::log_uniform && !(p[0] > 0.0) ? "has an end that is not positive" : "";
  }
  return {};
}

}  // namespace

Distribution::Distribution(Kind kind, std::vector<double> parameters)
    : kind_(kind), parameters_(std::move(parameters)) {
  if (const std::string found = fault(kind_, parameters_); !found.empty())
    throw InputError("distribution", found, kValid);
  if (kind_ != Kind::choice) return;
  ascending_ = parameters_;
  std::sort(ascending_.begin(), ascending_.end());
}

double Distribution::draw(RandomStream& stream) const {
  return value(stream.uniform(), parameters_);
}

double Distribution::quantile(double u) const {
  return value(u, ascending_);
}

double Distribution::value(double u, const std::vector<double>& choices) const {
  const double a = parameters_.front();
  const double b = parameters_.back();
  switch (kind_) {
    case Kind::fixed:
      return a;
    case Kind::uniform:
      return a + (b - a) * u;
    case Kind::normal:
      return a + b * normal_quantile(std::max(u, 0x1p-54));  // the quantile of 0 is infinite
    case Kind::log_uniform:
      return std::clamp(a * std::pow(b / a, u), a, b);
    case Kind::choice:
      return choices[std::min(static_cast<std::size_t>(u * static_cast<double>(choices.size())), choices.size() - 1)];
  }
  return a;
}

double Distribution::share_below(double x) const {
  const double a = parameters_.front();
  const double b = parameters_.back();
  switch (kind_) {
    case Kind::fixed:
      return x > a ? 1.0 : 0.0;
    case Kind::uniform:
      return a < b ? std::clamp((x - a) / (b - a), 0.0, 1.0) : (x > a ? 1.0 : 0.0);
    case Kind::normal:
      return b > 0.0 ? 0.5 * std::erfc((a - x) / (b * std::numbers::sqrt2)) : (x > a ? 1.0 : 0.0);
    case Kind::log_uniform:
      if (x <= a) return 0.0;
      return a < b ? std::min(std::log(x / a) / std::log(b / a), 1.0) : 1.0;
    case Kind::choice:
      return static_cast<double>(std::lower_bound(ascending_.begin(), ascending_.end(), x) - ascending_.begin()) /
             static_cast<double>(ascending_.size());
  }
  return 0.0;
}

Distribution read_distribution(TableReader& table, const std::string& key, Range range) {
  if (SurveyedKey* entry = surveyed(table, key)) {
    entry->type = "number or distribution";
    entry->valid.insert(describe(range));
  }
  const toml::node* node = table.node(key);
  if (!node || !node->is_table()) {
    if (node && !node->is_number()) throw table.error(key, "is not a number", kValid);
    return table.number(key, range);
  }

  TableReader form_table = table.table(key);
  std::vector<const Form*> given;
  for (const Form& form : kForms)
    if (form_table.has(form.name)) given.push_back(&form);
  form_table.finish();
  if (given.size() != 1) throw table.error(key, "does not name one distribution", kValid);

  const Form& form = *given.front();
  if (form.kind == Kind::normal && (range.low > kAnyNumber.low || range.high < kAnyNumber.high))
    throw table.error(key, "is limited in range, and a normal distribution is not", "uniform, log_uniform or choice");
  std::vector<double> parameters = form_table.numbers(form.name, form.parameters, range);
  if (const std::string found = fault(form.kind, parameters); !found.empty())
    throw form_table.error(form.name, found, kValid);
  return {form.kind, std::move(parameters)};
}

Distribution read_distribution_or(TableReader& table, const std::string& key, double fallback, Range range) {
  if (SurveyedKey* entry = surveyed(table, key)) {
    entry->type = "number or distribution";
    entry->valid.insert(describe(range));
    entry->defaults.insert(fmt::format("{}", fallback));
  }
  return table.has(key) ? read_distribution(table, key, range) : Distribution(fallback);
}

}  // namespace truebearing
