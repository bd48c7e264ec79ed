// SPDX-License-Identifier: BSD-3-Clause
#include "Parser.hh"

#include <CLI/CLI.hpp>
#include <cstdint>
#include <optional>
#include <sstream>

#include "ExitCode.hh"
#include "hfremesh/HalfFace/Handles.hh"

namespace hfr::app {
namespace {

/// Examples of a command: its footer holds them, a line each, until the help is asked for.
std::vector<Example> examples_of(const CLI::App& app) {
  std::istringstream lines(app.get_footer());
  std::vector<Example> examples;
  std::string line;
  while (std::getline(lines, line)) {
    const std::size_t tab = line.find('\t');
    examples.push_back({line.substr(0, tab), line.substr(tab + 1)});
  }
  return examples;
}

/// The values of one_of(), which CLI11 keeps as "NAME:{a,b}" in the name of the type; taken out of `type`.
std::vector<std::string> take_choices(std::string& type) {
  const std::size_t begin = type.find('{');
  if (begin == std::string::npos) return {};
  std::istringstream list(type.substr(begin + 1, type.rfind('}') - begin - 1));
  type.resize(begin > 0 && type[begin - 1] == ':' ? begin - 1 : begin);
  std::vector<std::string> choices;
  std::string choice;
  while (std::getline(list, choice, ',')) choices.push_back(choice);
  return choices;
}

OptionFacts facts_of(const CLI::Option& option) {
  OptionFacts facts;
  facts.group = option.get_group();
  for (const std::string& name : option.get_snames()) facts.names.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) facts.names.push_back("--" + name);
  if (option.get_positional()) facts.place = option.get_name(true, false);
  if (option.get_type_size() != 0) facts.value = option.get_type_name();
  facts.choices = take_choices(facts.value);
  if (option.get_positional() && facts.names.empty()) facts.value = facts.place;
  facts.help = option.get_description();
  facts.standard = option.get_default_str();
  facts.required = option.get_required();
  return facts;
}

CommandFacts facts_of(const CLI::App& app) {
  CommandFacts facts;
  facts.name = app.get_name();
  facts.path = facts.name;
  for (const CLI::App* above = app.get_parent(); above != nullptr; above = above->get_parent())
    facts.path = above->get_name() + " " + facts.path;
  facts.help = app.get_description();
  facts.examples = examples_of(app);
  const CLI::Option* help = app.get_help_ptr();
  for (const CLI::Option* option : app.get_options())
    if (option != help) facts.options.push_back(facts_of(*option));
  facts.options.push_back(facts_of(*help));  // the last thing that a reader of the help looks for
  facts.options.back().group = "Every subcommand";
  for (const CLI::App* below : app.get_subcommands([](const CLI::App*) { return true; }))
    facts.subcommands.push_back(facts_of(*below));
  return facts;
}

}  // namespace

Option& Option::required() {
  option_->required();
  return *this;
}

Option& Option::type_name(const std::string& name) {
  option_->type_name(name);
  return *this;
}

Option& Option::check(ValueCheck wrong) {
  option_->check(CLI::Validator(std::move(wrong), ""));
  return *this;
}

Option& Option::transform(ValueCheck rewrite) {
  option_->transform(CLI::Validator(std::move(rewrite), ""));
  return *this;
}

Option& Option::one_of(std::initializer_list<const char*> values) {
  option_->check(CLI::IsMember(std::vector<std::string>(values.begin(), values.end())));
  return *this;
}

Option& Option::one_of(std::initializer_list<int> values) {
  option_->check(CLI::IsMember(values));
  return *this;
}

Option& Option::expected(int n) {
  option_->expected(n);
  return *this;
}

Option& Option::expected(int least, int most) {
  option_->expected(least, most);
  return *this;
}

Option& Option::delimiter(char separator) {
  option_->delimiter(separator);
  return *this;
}

Option& Option::one_a_use() {
  option_->allow_extra_args(false);
  return *this;
}

Option& Option::shows_default() {
  option_->capture_default_str();
  return *this;
}

Option& Option::shows_default(const std::string& value) {
  option_->default_str(value);
  return *this;
}

Option& Option::excludes(const Option& other) {
  option_->excludes(other.option_);
  return *this;
}

Command Command::subcommand(const std::string& name, const std::string& help) {
  CLI::App* below = app_->add_subcommand(name, help);
  below->footer("");  // a subcommand takes over that of the program
  return Command(below);
}

void Command::require_subcommand() { app_->require_subcommand(1); }

void Command::group(const std::string& name) { app_->option_defaults()->group(name); }

void Command::example(const std::string& line, const std::string& what) {
  const std::string before = app_->get_footer();
  app_->footer(before + (before.empty() ? "" : "\n") + line + "\t" + what);
}

template <class T>
Option Command::option(const std::string& names, T& value, const std::string& help) {
  return Option(app_->add_option(names, value, help));
}

template Option Command::option(const std::string&, std::string&, const std::string&);
template Option Command::option(const std::string&, double&, const std::string&);
template Option Command::option(const std::string&, std::optional<double>&, const std::string&);
template Option Command::option(const std::string&, int&, const std::string&);
template Option Command::option(const std::string&, unsigned&, const std::string&);
template Option Command::option(const std::string&, unsigned long&, const std::string&);
template Option Command::option(const std::string&, unsigned long long&, const std::string&);
template Option Command::option(const std::string&, std::vector<std::string>&, const std::string&);
template Option Command::option(const std::string&, std::vector<double>&, const std::string&);
template Option Command::option(const std::string&, std::vector<Index>&, const std::string&);

Option Command::flag(const std::string& names, bool& given, const std::string& help) {
  return Option(app_->add_flag(names, given, help));
}

std::string Command::name() const { return app_->get_name(); }

CommandFacts Command::facts() const { return facts_of(*app_); }

bool Command::parsed() const { return app_->parsed(); }

std::string Command::chosen() const { return app_->get_subcommands().front()->get_name(); }

Parser::Parser(const std::string& name, const std::string& help, const std::string& version)
    : app_(std::make_unique<CLI::App>(help, name)) {
  app_->option_defaults()->group("Information");
  app_->set_version_flag("--version", version);
  app_->get_help_ptr()->description("Print this help");
  app_->formatter_fn(
      [](const CLI::App* app, std::string, CLI::AppFormatMode) { return help_text(facts_of(*app)); });
}

Parser::~Parser() = default;

bool Parser::parse(const std::vector<std::string>& arguments) {
  try {
    app_->parse(std::vector<std::string>(arguments.rbegin(), arguments.rend()));  // last first: its way
  } catch (const CLI::Success& wanted) {
    app_->exit(wanted);
    return false;
  } catch (const CLI::ParseError& error) {
    throw Failure(ExitCode::kUsage, error.what());
  }
  return true;
}

}  // namespace hfr::app
