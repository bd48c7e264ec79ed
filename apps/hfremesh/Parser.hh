// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_APPS_PARSER_HH
#define HFR_APPS_PARSER_HH

#include <functional>
#include <initializer_list>
#include <memory>
#include <string>
#include <vector>

#include "Help.hh"

namespace CLI {
class App;
class Option;
}  // namespace CLI

/// The command line as the subcommands describe it: a thin front of CLI11, which takes seconds to compile in
/// each source that includes it. Parser.cc alone does.
namespace hfr::app {

/// Looks at one value as it was given: says in a line what is wrong with it, "" where nothing is. May write
/// another value in its place where it is handed to Option::transform().
using ValueCheck = std::function<std::string(std::string& value)>;

/// An option of a Command, for as long as the Parser lives. Each member returns the option itself.
class Option {
 public:
  explicit Option(CLI::Option* option) : option_(option) {}

  Option& required();
  /// What stands for the value in the help.
  Option& type_name(const std::string& name);
  Option& check(ValueCheck wrong);
  Option& transform(ValueCheck rewrite);
  /// The values that there are.
  Option& one_of(std::initializer_list<const char*> values);
  Option& one_of(std::initializer_list<int> values);
  /// Values that one use of the option takes.
  Option& expected(int n);
  Option& expected(int least, int most);
  /// Between values in one word.
  Option& delimiter(char separator);
  /// An option that may repeat takes one word each time, and what follows is none of its own.
  Option& one_a_use();
  /// Shows the variable's present value in the help as what counts where none is given.
  Option& shows_default();
  /// The same in words, where the variable's value stands for something else.
  Option& shows_default(const std::string& value);
  /// Cannot stand beside `other`.
  Option& excludes(const Option& other);

 private:
  CLI::Option* option_;
};

/// A subcommand, or the program as a whole, for as long as the Parser lives.
class Command {
 public:
  explicit Command(CLI::App* app) : app_(app) {}

  Command subcommand(const std::string& name, const std::string& help);
  /// One of the subcommands has to be named.
  void require_subcommand();

  /// The heading of the options that are added from now on.
  void group(const std::string& name);
  /// One more of the lines that the help begins with.
  void example(const std::string& line, const std::string& what);

  /// `names` as "-o,--output", or a word without dashes for what is known by its place. What is given is
  /// stored in `value` while the line is parsed. T: std::string, double, std::optional<double>, int, the
  /// unsigned integers, and vectors of std::string, double and Index.
  template <class T>
  Option option(const std::string& names, T& value, const std::string& help);
  /// Without a value; `given` becomes true.
  Option flag(const std::string& names, bool& given, const std::string& help);

  std::string name() const;
  /// What there is to say of it and of all below.
  CommandFacts facts() const;
  /// Whether the line that was parsed names it.
  bool parsed() const;
  /// Name of the subcommand that it names. Precondition: require_subcommand(), and the line was parsed.
  std::string chosen() const;

 private:
  CLI::App* app_;
};

class Parser {
 public:
  /// `version` is what --version prints.
  Parser(const std::string& name, const std::string& help, const std::string& version);
  ~Parser();
  Parser(const Parser&) = delete;
  Parser& operator=(const Parser&) = delete;

  Command program() { return Command(app_.get()); }
  /// False where help or version were asked for, which have been printed. Throws Failure with
  /// ExitCode::kUsage.
  bool parse(const std::vector<std::string>& arguments);

 private:
  std::unique_ptr<CLI::App> app_;
};

}  // namespace hfr::app

#endif
