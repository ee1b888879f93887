/// \file
/// How the subcommands of `stickslip` come to the parser, in groups of one file each. A group declares its
/// options; what a command does is in commands.hpp.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "cli/scene_options.hpp"
#include <CLI/CLI.hpp>

#include "core/base/result.hpp"

namespace stickslip::cli {

/// What is to be run once all is parsed.
struct Chosen {
  std::string line;          ///< The whole command, as a shell would take it again.
  std::function<int()> run;  ///< \return the exit status.
};

/// Option before the second list of `stickslip compare`; a plain -- does the same.
inline constexpr const char* kOtherMaterial = "--against";

void add_making_commands(CLI::App& app, Chosen& chosen);       ///< import, simulate, sweep
void add_showing_commands(CLI::App& app, Chosen& chosen);      ///< plot, accuracy, report, compare
void add_analysing_commands(CLI::App& app, Chosen& chosen);    ///< analyze, characterise
void add_asking_commands(CLI::App& app, Chosen& chosen);       ///< scenes, methods, boards, status
void add_calibrating_commands(CLI::App& app, Chosen& chosen);  ///< calibrate
void add_commanding_commands(CLI::App& app, Chosen& chosen);  ///< arm, start, stop, mark, tare, plan, list …
void add_exporting_commands(CLI::App& app, Chosen& chosen);   ///< export
void add_caring_commands(CLI::App& app, Chosen& chosen);      ///< verify, recover

void add_doctor(CLI::App& app, Chosen& chosen);  ///< doctor
void add_demo(CLI::App& app, Chosen& chosen);    ///< demo

/// man, completion: made from the parser itself.
/// \param app  outlives the parser's run.
void add_manual(CLI::App& app, Chosen& chosen);

/// What a command gave, on stdout, or its error on stderr. \return the exit status.
[[nodiscard]] int print(const base::Result<std::string>& output);

/// \param chosen  outlives the parser. \param run  called if the command is the one given.
void choose(CLI::App& command, Chosen& chosen, std::function<base::Result<std::string>()> run);

// Options of several groups.

void add_method_option(CLI::App& command, std::string& method);
/// Scene and changes.
void add_scene_options(CLI::App& command, SceneOptions& options);

}  // namespace stickslip::cli
