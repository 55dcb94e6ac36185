// SPDX-License-Identifier: Apache-2.0
#include "app/arguments.hpp"

#include <CLI/CLI.hpp>
#include <charconv>
#include <cmath>
#include <concepts>
#include <cstdint>
#include <optional>
#include <string>
#include <system_error>
#include <utility>

namespace truebearing {
namespace {

// An option's name where its value was forgotten would be taken for it.
std::string name_error(const std::string& value) {
  if (value.empty()) return "is empty";
  return value.size() > 1 && value.front() == '-' ? value + " is no name (./" + value + " is one)" : "";
}

std::string count_error(const std::string& value) {
  if (!value.empty() && value.front() == '-') return value + " is negative";
  const char* const end = value.data() + value.size();
  std::uint64_t count = 0;
  const auto [stop, error] = std::from_chars(value.data(), end, count);
  return stop == end && error == std::errc::result_out_of_range ? value + " is above 18446744073709551615" : "";
}

std::string nan_error(const std::string& value) {
  double number = 0.0;
  return CLI::detail::lexical_cast(value, number) && std::isnan(number) ? value + " is no number" : "";
}

// Text names something; of numbers without a sign the library takes -1 for the largest,
// and what is larger too.
template <typename Value>
void check_value(CLI::Option* option) {
  if constexpr (std::same_as<Value, std::string> || std::same_as<Value, std::vector<std::string>>)
    option->check(CLI::Validator(name_error, ""));
  if constexpr (std::same_as<Value, std::uint64_t> || std::same_as<Value, std::optional<std::uint64_t>>)
    option->check(CLI::Validator(count_error, ""));
  if constexpr (std::same_as<Value, double> || std::same_as<Value, std::vector<double>>)
    option->check(CLI::Validator(nan_error, ""));
}

// As the library's own, which prints the greatest number there is in full.
std::string sign_error(const std::string& value) {
  double number = 0.0;
  return CLI::detail::lexical_cast(value, number) && number > 0.0 ? "" : value + " is no number > 0";
}

std::string negative_error(const std::string& value) {
  double number = 0.0;
  const bool fits = CLI::detail::lexical_cast(value, number) && number >= 0.0 && std::isfinite(number);
  return fits ? "" : value + " is no finite number >= 0";
}

}  // namespace

Argument Argument::required() const {
  option_->required();
  return *this;
}

Argument Argument::one_of(const std::vector<std::string>& values) const {
  option_->check(CLI::IsMember(values));
  return *this;
}

Argument Argument::within(int least, int greatest) const {
  option_->check(CLI::Range(least, greatest));
  return *this;
}

Argument Argument::positive() const {
  option_->check(CLI::Validator(sign_error, "POSITIVE"));
  return *this;
}

Argument Argument::non_negative() const {
  option_->check(CLI::Validator(negative_error, "NONNEGATIVE"));
  return *this;
}

Argument Argument::needs(const Argument& other) const {
  option_->needs(other.option_);
  return *this;
}

Argument Argument::read_as(std::function<std::string(std::string)> meaning) const {
  option_->transform(meaning, "");
  return *this;
}

Argument Argument::default_shown() const {
  option_->capture_default_str();
  return *this;
}

template <typename Value>
Argument Subcommand::argument(const std::string& names, Value& value, const std::string& description) const {
  CLI::Option* option = app_->add_option(names, value, description);
  check_value<Value>(option);
  return Argument{option};
}

Argument Subcommand::flag(const std::string& name, bool& value, const std::string& description) const {
  return Argument{app_->add_flag(name, value, description)};
}

void Subcommand::runs(std::function<void()> work) const {
  app_->callback(std::move(work));
}

Subcommand Subcommands::add(const std::string& name, const std::string& description) const {
  return Subcommand{app_->add_subcommand(name, description)};
}

template Argument Subcommand::argument(const std::string&, std::string&, const std::string&) const;
template Argument Subcommand::argument(const std::string&, std::vector<std::string>&, const std::string&) const;
template Argument Subcommand::argument(const std::string&, std::vector<double>&, const std::string&) const;
template Argument Subcommand::argument(const std::string&, int&, const std::string&) const;
template Argument Subcommand::argument(const std::string&, double&, const std::string&) const;
template Argument Subcommand::argument(const std::string&, std::uint64_t&, const std::string&) const;
template Argument Subcommand::argument(const std::string&, std::optional<std::uint64_t>&, const std::string&) const;

}  // namespace truebearing
