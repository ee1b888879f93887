/// \file
/// The subcommands of `stickslip`. X.cpp holds all of `stickslip X`: its options and its help, which add_X()
/// gives to the parser, and what it does. Nothing is printed and no file is left before all of it has
/// succeeded.
#pragma once

#include <functional>
#include <string>

#include <CLI/CLI.hpp>

#include "core/base/result.hpp"

namespace stickslip::cli {

/// What is to be run once all is parsed.
struct Chosen {
  std::string line;          ///< The whole command, as a shell would take it again.
  std::function<int()> run;  ///< \return the exit status.
};

// In the order in which help shows them. The parser and `chosen` outlive what is run.

void add_demo(CLI::App& app, Chosen& chosen);
void add_import(CLI::App& app, Chosen& chosen);
void add_simulate(CLI::App& app, Chosen& chosen);
void add_sweep(CLI::App& app, Chosen& chosen);
void add_plot(CLI::App& app, Chosen& chosen);
void add_accuracy(CLI::App& app, Chosen& chosen);
void add_report(CLI::App& app, Chosen& chosen);
void add_compare(CLI::App& app, Chosen& chosen);
void add_find(CLI::App& app, Chosen& chosen);
void add_law(CLI::App& app, Chosen& chosen);
void add_trend(CLI::App& app, Chosen& chosen);
void add_scenes(CLI::App& app, Chosen& chosen);
void add_boards(CLI::App& app, Chosen& chosen);
void add_methods(CLI::App& app, Chosen& chosen);
void add_status(CLI::App& app, Chosen& chosen);
void add_page(CLI::App& app, Chosen& chosen);
void add_arm(CLI::App& app, Chosen& chosen);
void add_start(CLI::App& app, Chosen& chosen);
void add_stop(CLI::App& app, Chosen& chosen);
void add_mark(CLI::App& app, Chosen& chosen);
void add_tare(CLI::App& app, Chosen& chosen);
void add_plan(CLI::App& app, Chosen& chosen);
void add_batch(CLI::App& app, Chosen& chosen);
void add_void(CLI::App& app, Chosen& chosen);
void add_list(CLI::App& app, Chosen& chosen);
void add_show(CLI::App& app, Chosen& chosen);
void add_watch(CLI::App& app, Chosen& chosen);
void add_analyze(CLI::App& app, Chosen& chosen);
void add_characterise(CLI::App& app, Chosen& chosen);
void add_verify(CLI::App& app, Chosen& chosen);
void add_recover(CLI::App& app, Chosen& chosen);
void add_doctor(CLI::App& app, Chosen& chosen);
void add_bundle(CLI::App& app, Chosen& chosen);
void add_man(CLI::App& app, Chosen& chosen);
void add_completion(CLI::App& app, Chosen& chosen);
void add_export(CLI::App& app, Chosen& chosen);
void add_calibrate(CLI::App& app, Chosen& chosen);

/// Option before the second list of `stickslip compare`; a plain -- does the same.
inline constexpr const char* kOtherMaterial = "--against";

/// What a command gave, on stdout, or its error on stderr. \return the exit status.
[[nodiscard]] int print(const base::Result<std::string>& output);

/// \param chosen  outlives the parser. \param run  called if the command is the one given.
void choose(CLI::App& command, Chosen& chosen, std::function<base::Result<std::string>()> run);

}  // namespace stickslip::cli
