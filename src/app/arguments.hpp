// SPDX-License-Identifier: Apache-2.0
// What a subcommand takes from the command line, said without the library that reads it: CLI11 is compiled in
// arguments.cpp alone.
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace truebearing {

/// One argument, and what is asked of it. A handle: copies speak of the same one.
class Argument {
 public:
  explicit Argument(CLI::Option* option) : option_(option) {}

  Argument required() const;
  Argument one_of(const std::vector<std::string>& values) const;
  Argument within(int least, int greatest) const;
  Argument positive() const;
  Argument non_negative() const;
  /// Refused without `other`.
  Argument needs(const Argument& other) const;
  /// The value is what `meaning` makes of what was written.
  Argument read_as(std::function<std::string(std::string)> meaning) const;
  /// --help says which value stands where none is given.
  Argument default_shown() const;

 private:
  CLI::Option* option_;
};

/// One subcommand: its arguments and what it runs. Values are written before it runs and must live until then.
class Subcommand {
 public:
  explicit Subcommand(CLI::App* app) : app_(app) {}

  /// `names` is a position's name ("study"), or "--long" or "-s,--long" of an option. Of the types at the end of
  /// arguments.cpp.
  template <typename Value>
  Argument argument(const std::string& names, Value& value, const std::string& description) const;
  /// An option without a value.
  Argument flag(const std::string& name, bool& value, const std::string& description) const;
  /// `work` throws InputError where the input is at fault.
  void runs(std::function<void()> work) const;

 private:
  CLI::App* app_;
};

/// The program's subcommands, in the order in which --help lists them.
class Subcommands {
 public:
  explicit Subcommands(CLI::App& app) : app_(&app) {}

  Subcommand add(const std::string& name, const std::string& description) const;

 private:
  CLI::App* app_;
};

}  // namespace truebearing
