// SPDX-License-Identifier: BSD-3-Clause
#include "Completion.hh"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <functional>

namespace hfr::app {
namespace {

/// Calls `f(command, words)` for the program and all below it; `words` are the subcommands that lead there.
void for_each(const CommandFacts& command, const std::string& words,
              const std::function<void(const CommandFacts&, const std::string&)>& f) {
  f(command, words);
  for (const CommandFacts& below : command.subcommands)
    for_each(below, words.empty() ? below.name : words + " " + below.name, f);
}

/// What can stand at the end of "hfremesh WORDS ".
std::string words_after(const CommandFacts& command) {
  std::vector<std::string> words;
  for (const CommandFacts& below : command.subcommands) words.push_back(below.name);
  for (const OptionFacts& option : command.options) {
    words.insert(words.end(), option.names.begin(), option.names.end());
    if (option.is_place()) words.insert(words.end(), option.choices.begin(), option.choices.end());
  }
  return fmt::format("{}", fmt::join(words, " "));
}

bool takes_file(const OptionFacts& option) {
  return option.value == "FILE" || option.value.starts_with("FILE ") || option.value == "PATTERN";
}

/// Text within single quotes.
std::string quoted(const std::string& text, const char* quote_as) {
  std::string out;
  for (const char c : text) {
    if (c == '\'')
      out += quote_as;
    else
      out += c;
  }
  return "'" + out + "'";
}

/// A line of zsh's _arguments for an option; brackets and colons are its own.
std::string zsh_spec(const OptionFacts& option) {
  std::string help;
  for (const char c : option.help) {
    if (c == '[' || c == ']' || c == ':' || c == '\\') help += '\\';
    help += c;
  }
  std::string action;
  if (!option.choices.empty())
    action = fmt::format("({})", fmt::join(option.choices, " "));
  else if (takes_file(option) || option.is_place())
    action = "_files";
  if (option.is_place() && option.names.empty()) return fmt::format("'*:{}:{}'", option.place, action);
  std::string lines;
  for (const std::string& name : option.names) {
    const std::string value = option.value.empty() ? "" : fmt::format(":{}:{}", option.value, action);
    lines += quoted(fmt::format("*{}[{}]{}", name, help, value), "'\\''") + " ";
  }
  lines.pop_back();
  return lines;
}

void add_zsh_function(const CommandFacts& command, const std::string& words, std::string& out) {
  std::string name = "_hfremesh";
  for (const char c : words) name += c == ' ' ? '_' : c;
  if (!words.empty()) name.insert(9, "_");
  out += name + "() {\n";
  if (!command.subcommands.empty()) {
    out += "  local -a below\n  below=(\n";
    for (const CommandFacts& sub : command.subcommands)
      out += "    " + quoted(sub.name + ":" + sub.help, "'\\''") + "\n";
    out += "  )\n  if (( CURRENT == 2 )); then\n    _describe subcommand below\n";
    if (words.empty()) out += "    _files\n";
    out += "    return\n  fi\n  local chosen=$words[2]\n  case $chosen in\n";
    for (const CommandFacts& sub : command.subcommands)
      out += fmt::format("    {0}) shift words; (( CURRENT-- )); {1}_{0}; return ;;\n", sub.name,
                         words.empty() ? "_hfremesh_" : name);
    out += "  esac\n";
    if (words.empty()) out += "  _hfremesh__improve\n";
  } else {
    out += "  _arguments -s";
    for (const OptionFacts& option : command.options) out += " \\\n    " + zsh_spec(option);
    out += "\n";
  }
  out += "}\n\n";
}

/// fish's condition for a command: its words were typed, and none of a subcommand below it.
std::string fish_condition(const CommandFacts& command, const std::string& words) {
  std::string names;
  for (const CommandFacts& below : command.subcommands) names += " " + below.name;
  std::string condition;
  std::string word;
  for (const char c : words + " ") {
    if (c != ' ') {
      word += c;
    } else if (!word.empty()) {
      condition += (condition.empty() ? "" : "; and ") + ("__fish_seen_subcommand_from " + word);
      word.clear();
    }
  }
  if (!names.empty())
    condition += (condition.empty() ? "" : "; and ") + ("not __fish_seen_subcommand_from" + names);
  return condition;
}

std::string fish_option(const OptionFacts& option) {
  std::string line;
  for (const std::string& name : option.names)
    line += name.starts_with("--") ? " -l " + name.substr(2) : " -s " + name.substr(1);
  if (!option.value.empty()) line += takes_file(option) || option.is_place() ? " -r -F" : " -x";
  if (!option.choices.empty())
    line += " -a " + quoted(fmt::format("{}", fmt::join(option.choices, " ")), "\\'");
  return line + " -d " + quoted(option.help, "\\'");
}

}  // namespace

std::string bash_completion(const CommandFacts& program) {
  std::string words_of, values_of, files;
  for_each(program, "", [&](const CommandFacts& command, const std::string& words) {
    words_of += fmt::format("    '{}') echo '{}' ;;\n", words, words_after(command));
    for (const OptionFacts& option : command.options)
      for (const std::string& name : option.names) {
        if (option.value.empty()) continue;
        const std::string what = !option.choices.empty() ? fmt::format("{}", fmt::join(option.choices, " "))
                                 : takes_file(option) || option.is_place() ? "FILES"
                                                                           : "NONE";
        values_of += fmt::format("    '{} {}') echo '{}' ;;\n", words, name, what);
      }
  });
  std::string subcommands;
  for_each(program, "", [&](const CommandFacts& command, const std::string& words) {
    if (!command.subcommands.empty())
      for (const CommandFacts& below : command.subcommands)
        subcommands += fmt::format("      '{}{}{}') words='{}{}{}' ;;\n", words, words.empty() ? "" : " ",
                                   below.name, words, words.empty() ? "" : " ", below.name);
  });
  return "# bash completion of hfremesh, made by 'hfremesh manual bash'\n"
         "_hfremesh_words() {\n  case \"$1\" in\n" +
         words_of + "  esac\n}\n\n_hfremesh_values() {\n  case \"$1\" in\n" + values_of +
         "  esac\n}\n\n_hfremesh() {\n"
         "  local current=${COMP_WORDS[COMP_CWORD]} previous=${COMP_WORDS[COMP_CWORD - 1]} words='' i\n"
         "  for ((i = 1; i < COMP_CWORD; ++i)); do\n"
         "    case \"${words}${words:+ }${COMP_WORDS[i]}\" in\n" +
         subcommands +
         "      *) break ;;\n    esac\n  done\n"
         "  # A mesh in place of a subcommand is improved.\n"
         "  if [[ -z $words && $COMP_CWORD -gt 1 ]]; then words=improve; fi\n"
         "  local values\n"
         "  values=$(_hfremesh_values \"$words $previous\")\n"
         "  COMPREPLY=()\n"
         "  case \"$values\" in\n"
         "    NONE) return ;;\n"
         "    FILES) mapfile -t COMPREPLY < <(compgen -f -- \"$current\") ; return ;;\n"
         "    ?*) mapfile -t COMPREPLY < <(compgen -W \"$values\" -- \"$current\") ; return ;;\n"
         "  esac\n"
         "  mapfile -t COMPREPLY < <(compgen -W \"$(_hfremesh_words \"$words\")\" -- \"$current\")\n"
         "  if [[ $current != -* ]]; then mapfile -t -O ${#COMPREPLY[@]} COMPREPLY < <(compgen -f -- "
         "\"$current\"); "
         "fi\n"
         "}\n"
         "complete -o filenames -F _hfremesh hfremesh\n";
}

std::string zsh_completion(const CommandFacts& program) {
  std::string out = "#compdef hfremesh\n# zsh completion of hfremesh, made by 'hfremesh manual zsh'\n\n";
  for_each(program, "", [&](const CommandFacts& command, const std::string& words) {
    add_zsh_function(command, words, out);
  });
  return out + "_hfremesh \"$@\"\n";
}

std::string fish_completion(const CommandFacts& program) {
  std::string out = "# fish completion of hfremesh, made by 'hfremesh manual fish'\n";
  for_each(program, "", [&](const CommandFacts& command, const std::string& words) {
    const std::string condition = quoted(fish_condition(command, words), "\\'");
    for (const CommandFacts& below : command.subcommands)
      out += fmt::format("complete -c hfremesh -n {} -a {} -d {}\n", condition, below.name,
                         quoted(below.help, "\\'"));
    for (const OptionFacts& option : command.options)
      if (!option.names.empty() || !option.choices.empty())
        out += fmt::format("complete -c hfremesh -n {}{}\n", condition, fish_option(option));
  });
  return out;
}

}  // namespace hfr::app
