#include "cli/manual/completion.hpp"

#include <fmt/format.h>

#include <vector>

#include "cli/manual/commands_of.hpp"

namespace stickslip::manual {
namespace {

struct Word {
  std::string text;  ///< "--json", "import".
  std::string what;
  bool takes_value = false;
};

std::vector<Word> options_of(const CLI::App& app) {
  std::vector<Word> words;
  for (const CLI::Option* option : app.get_options()) {
    if (option->get_positional() || option->get_group().empty()) continue;
    const bool takes_value = option->get_items_expected_max() > 0;
    for (const std::string& name : option->get_lnames())
      words.push_back({"--" + name, option->get_description(), takes_value});
    for (const std::string& name : option->get_snames())
      words.push_back({"-" + name, option->get_description(), takes_value});
  }
  return words;
}

std::string list_of(const std::vector<Word>& words) {
  std::string list;
  for (const Word& word : words) list += (list.empty() ? "" : " ") + word.text;
  return list;
}

/// Quotes a text in single quotes for all three shells. \param also  characters that get a backslash.
std::string quoted(const std::string& text, char also = '\0') {
  std::string out = "'";
  for (const char c : text) {
    if (c == '\'') {
      out += "'\\''";
    } else {
      if (c == also && also != '\0') out += '\\';
      out += c;
    }
  }
  return out + "'";
}

std::string function_of(const std::string& program) { return "_" + program; }

}  // namespace

std::string bash_completion(const CLI::App& app, const std::string& program) {
  std::string commands;
  std::string cases;
  for (const CLI::App* command : commands_of(app)) {
    commands += command->get_name() + " ";
    cases += fmt::format("    {}) words='{}' ;;\n", command->get_name(), list_of(options_of(*command)));
  }
  // With a command only what begins with a minus is completed from the list, everything else as a file.
  return fmt::format(R"(# bash completion for {0}
{1}() {{
  local current=${{COMP_WORDS[COMP_CWORD]}} command='' words i
  for ((i = 1; i < COMP_CWORD; ++i)); do
    if [[ ${{COMP_WORDS[i]}} != -* ]]; then
      command=${{COMP_WORDS[i]}}
      break
    fi
  done
  COMPREPLY=()
  case $command in
    '') words='{2}{3}' ;;
{4}    *) return ;;
  esac
  if [[ -z $command{5} || $current == -* ]]; then
    mapfile -t COMPREPLY < <(compgen -W "$words" -- "$current")
  fi
}}
complete -o default -F {1} {0}
)",
                     program, function_of(program), commands, list_of(options_of(app)), cases,
                     commands.empty() ? " && $current == -*" : "");
}

std::string zsh_completion(const CLI::App& app, const std::string& program) {
  const auto described = [](const std::vector<Word>& words) {
    std::string list;
    for (const Word& word : words)
      list += fmt::format(" {}", quoted(fmt::format("{}:{}", word.text, word.what)));
    return list;
  };
  std::vector<Word> commands;
  std::string cases;
  for (const CLI::App* command : commands_of(app)) {
    commands.push_back({command->get_name(), command->get_description()});
    cases += fmt::format("    {}) found=({}) ;;\n", command->get_name(), described(options_of(*command)));
  }
  return fmt::format(R"(#compdef {0}
# zsh completion for {0}
{1}() {{
  local -a found
  local command=''
  if (( CURRENT > 2 )); then
    command=${{words[2]}}
  fi
  case $command in
{4}    *) found=({2}{3}) ;;
  esac
  if [[ ( -z $command && -n '{5}' ) || $PREFIX == -* ]]; then
    _describe '{0}' found
  else
    _files
  fi
}}
compdef {1} {0}
)",
                     program, function_of(program), described(commands), described(options_of(app)), cases,
                     commands.empty() ? "" : "commands");
}

std::string fish_completion(const CLI::App& app, const std::string& program) {
  std::string text = fmt::format("# fish completion for {}\n", program);
  const auto options = [&](const CLI::App& of, const std::string& when) {
    for (const Word& word : options_of(of)) {
      const bool is_long = word.text.starts_with("--");
      text += fmt::format("complete -c {}{} {} {}{} -d {}\n", program, when, is_long ? "-l" : "-s",
                          word.text.substr(is_long ? 2 : 1), word.takes_value ? " -r" : "",
                          quoted(word.what, '\\'));
    }
  };
  const auto commands = commands_of(app);
  options(app, commands.empty() ? "" : " -n __fish_use_subcommand");
  for (const CLI::App* command : commands) {
    text += fmt::format("complete -c {} -f -n __fish_use_subcommand -a {} -d {}\n", program,
                        command->get_name(), quoted(command->get_description(), '\\'));
    options(*command, fmt::format(" -n '__fish_seen_subcommand_from {}'", command->get_name()));
  }
  return text;
}

}  // namespace stickslip::manual
