#include "app/arguments.hpp"

#include <CLI/CLI.hpp>
#include <cstdint>
#include <optional>
#include <utility>

namespace truebearing {

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
  option_->check(CLI::PositiveNumber);
  return *this;
}

Argument Argument::needs(const Argument& other) const {
  option_->needs(other.option_);
  return *this;
}

Argument Argument::default_shown() const {
  option_->capture_default_str();
  return *this;
}

template <typename Value>
Argument Subcommand::argument(const std::string& names, Value& value, const std::string& description) const {
  return Argument{app_->add_option(names, value, description)};
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
template Argument Subcommand::argument(const std::string&, int&, const std::string&) const;
template Argument Subcommand::argument(const std::string&, double&, const std::string&) const;
template Argument Subcommand::argument(const std::string&, std::uint64_t&, const std::string&) const;
template Argument Subcommand::argument(const std::string&, std::optional<int>&, const std::string&) const;
template Argument Subcommand::argument(const std::string&, std::optional<std::uint64_t>&, const std::string&) const;

}  // namespace truebearing
