// stickslip: the command line. Exit status 0 done, 1 the world did not allow it, 2 usage or input, 74
// the output cannot be written, 130 interrupted.

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <exception>
#include <set>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "cli/subcommands.hpp"
#include "io/print_text.hpp"
#include <CLI/CLI.hpp>

#include "core/base/shell_word.hpp"
#include "core/base/version.hpp"
#include "core/base/wording.hpp"
#include "core/record/read_apart.hpp"

namespace stickslip::cli {
namespace {

constexpr const char* kExamples = R"(Examples:
  stickslip demo                                       ten simulated tests, without a board
  stickslip import pull.csv --column force --rate "350 Hz" --unit N --sled-mass "2331 g" -o pull.h5
  stickslip import trace.csv --column mu --rate "2 kHz" --unit coefficient --speed "12 in/min" -o trace.h5
  stickslip scenes                                     the shipped scenes, one line each
  stickslip simulate stick-slip-at-12-in-per-min -o pull.h5 --seed 7
  stickslip sweep ring-down-at-12-in-per-min --vary paper.mu_s=0.31:0.35:5 --repeat 20 -o sweep.h5
  stickslip plot pull.h5 --from 1 --to 2               pull.svg: force, modes, peaks
  stickslip accuracy threshold-oscillation -o a.html   error against time, for each way to solve it
  stickslip analyze records/*.h5                       a table, with the truth where it is known
  stickslip analyze trace.h5 --method iso-8295         stickslip methods lists the shipped ones
  stickslip analyze trace.h5 --estimator turning-points   S and K from peaks and troughs, without a fit
  stickslip analyze trace.h5 --json                    {"tests": [{"file": …, results …, "details": …}]}
  stickslip characterise ring-down.h5 -o tester.toml   omega and gamma of the tester, for --tester
  stickslip report records/*.h5 -o report.html         replicates, coefficient against speed, traces
  stickslip compare a*.h5 -- b*.h5                     do two materials differ, and how many tests would show it
  stickslip find records --regime stick-slip --where S-K=0.04:   records, by what is in them
  stickslip law records/*.h5                           friction law, from tests at several pull speeds
  stickslip trend records                              has the tester shifted? Control charts
  stickslip verify records/*.h5                        whole or not, and why; exit status 0, 1, 3 or 4
  stickslip recover records                            records from the journals that a stop left behind
  stickslip boards                                     A/D boards, what they offer, what to configure
  stickslip export pull.h5 --csv > pull.csv            scans for a spreadsheet
  stickslip calibrate --config stickslipd.toml         the load cell, by hanging known weights
  stickslip doctor                                     is everything there that a test needs?
  stickslip bundle                                     one file for support, to read and send
  stickslip status                                     what the daemon is doing
  stickslip plan --name "liner 42" --replicate 3       what the tests to come are of
  stickslip start; stickslip mark "sheet moved"; stickslip stop
  stickslip watch                                      tests and cycles as they happen)";

/// In `stickslip compare` a plain -- stands between two lists; to the parser that is an option with values,
/// after which options may follow.
std::vector<std::string> words(int count, char** arguments) {
  std::vector<std::string> words(arguments + 1, arguments + count);
  if (!words.empty() && words.front() == "compare") {
    if (const auto mark = std::find(words.begin(), words.end(), "--"); mark != words.end())
      *mark = kOtherMaterial;
  }
  if (words.empty()) return words;
  // The other spelling, and `help`, `help COMMAND`.
  for (const auto& [said, meant] : {std::pair{"analyse", "analyze"}, {"characterize", "characterise"}}) {
    if (words.front() == said) words.front() = meant;
  }
  if (words.front() == "help") {
    words.erase(words.begin());
    words.emplace_back("--help");
  }
  return words;
}

std::set<std::string, std::less<>> names_of_commands(const CLI::App& app) {
  std::set<std::string, std::less<>> names;
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; }))
    names.insert(command->get_name());
  return names;
}

/// Names the first word that is no subcommand or no option, and the nearest that is one; empty: each is
/// known.
std::string unknown_word(const CLI::App& app, const std::vector<std::string>& words) {
  const CLI::App* command = &app;
  std::string place = "stickslip";
  for (const std::string& word : words) {
    if (word == "--") break;
    if (!word.starts_with('-')) {
      const auto known = names_of_commands(*command);
      if (known.contains(word)) {
        command = command->get_subcommand(word);
        place += " " + word;
      } else if (command == &app) {
        return fmt::format("there is no subcommand \"{}\"; {}; see stickslip --help", base::one_line(word),
                           base::spelling_hint(word, known));
      }
      continue;
    }
    if (!word.starts_with("--")) continue;
    const std::string option = word.substr(0, word.find('='));
    if (command->get_option_no_throw(option) != nullptr) continue;
    std::set<std::string, std::less<>> known;
    for (const CLI::Option* own : command->get_options()) {
      for (const std::string& name : own->get_lnames()) known.insert("--" + name);
    }
    return fmt::format("{} has no option {}; {}; see {} --help", place, base::one_line(option),
                       base::spelling_hint(option, known), place);
  }
  return {};
}

/// The command as a shell would take it again.
std::string command_line(int count, char** arguments) {
  std::string line = "stickslip";
  for (int i = 1; i < count; ++i) line += " " + base::shell_word(arguments[i]);
  return line;
}

int main_of(int count, char** arguments) {
  CLI::App app{"stickslip: friction tests from the command line", "stickslip"};
  app.set_version_flag("--version", fmt::format("stickslip {} ({})", base::kVersion, base::kCommit));
  app.require_subcommand(1);
  Chosen chosen{command_line(count, arguments), {}};
  add_demo(app, chosen);
  add_import(app, chosen);
  add_simulate(app, chosen);
  add_sweep(app, chosen);
  add_plot(app, chosen);
  add_accuracy(app, chosen);
  add_report(app, chosen);
  add_compare(app, chosen);
  add_find(app, chosen);
  add_law(app, chosen);
  add_trend(app, chosen);
  add_scenes(app, chosen);
  add_boards(app, chosen);
  add_methods(app, chosen);
  add_status(app, chosen);
  add_page(app, chosen);
  add_arm(app, chosen);
  add_start(app, chosen);
  add_stop(app, chosen);
  add_mark(app, chosen);
  add_tare(app, chosen);
  add_plan(app, chosen);
  add_batch(app, chosen);
  add_void(app, chosen);
  add_list(app, chosen);
  add_show(app, chosen);
  add_watch(app, chosen);
  add_analyze(app, chosen);
  add_characterise(app, chosen);
  add_verify(app, chosen);
  add_recover(app, chosen);
  add_doctor(app, chosen);
  add_bundle(app, chosen);
  add_man(app, chosen);
  add_completion(app, chosen);
  add_export(app, chosen);
  add_calibrate(app, chosen);
  app.footer(kExamples);  // Behind the subcommands, each of which has its own.
  std::vector<std::string> typed = words(count, arguments);
  const std::string unknown = unknown_word(app, typed);
  std::reverse(typed.begin(), typed.end());  // As CLI11 takes them.
  try {
    app.parse(std::move(typed));
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) {
      std::ostringstream text;  // Of --help and --version.
      const int status = app.exit(error, text, text);
      io::print_text(stdout, text.str());
      return io::flushed("stickslip", status);
    }
    io::print_error("stickslip",
                    unknown.empty() ? fmt::format("{}; see stickslip --help", error.what()) : unknown);
    return 2;
  }
  return chosen.run();
}

}  // namespace
}  // namespace stickslip::cli

int main(int count, char** arguments) {
  stickslip::record::serve_if_reader(count, arguments);
  try {
    stickslip::record::read_records_apart();
    return stickslip::cli::main_of(count, arguments);
  } catch (const std::exception& error) {
    stickslip::io::print_error("stickslip", error.what());
    return 1;
  }
}
