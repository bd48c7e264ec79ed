// SPDX-License-Identifier: BSD-3-Clause
#include "Parser.hh"

#include <CLI/CLI.hpp>
#include <cstdint>
#include <optional>

#include "ExitCode.hh"
#include "hfremesh/HalfFace/Handles.hh"

namespace hfr::app {

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

Option& Option::excludes(const Option& other) {
  option_->excludes(other.option_);
  return *this;
}

Command Command::subcommand(const std::string& name, const std::string& help) {
  return Command(app_->add_subcommand(name, help));
}

void Command::require_subcommand() { app_->require_subcommand(1); }

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

bool Command::parsed() const { return app_->parsed(); }

std::string Command::chosen() const { return app_->get_subcommands().front()->get_name(); }

Parser::Parser(const std::string& name, const std::string& help, const std::string& version)
    : app_(std::make_unique<CLI::App>(help, name)) {
  app_->set_version_flag("--version", version);
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
