/// \file
/// The command-line options of stickslipd, declared once for the program, its manual page and its shell
/// completion.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include <CLI/CLI.hpp>

namespace stickslip::daemon {

struct DaemonOptions {
  std::string config;
  std::string config_to_check;
  std::string journal;
  std::optional<std::int64_t> scans;
  std::string record;
};

inline constexpr const char* kDaemonPurpose = "stickslipd: measures friction tests, one record per test";

/// \param options  outlives the parser.
inline void declare_daemon_options(CLI::App& app, DaemonOptions& options) {
  app.footer(R"(Examples:
  stickslipd --config config/demo.toml                  ten simulated tests, then a table
  stickslipd --config /etc/stickslip/stickslipd.toml    as the service does
  stickslipd --check-config my.toml                     says what is wrong; exit status 0 or 2
Each key is documented in config/stickslipd.toml. SIGTERM and SIGINT end a running test, finish
its file and end the daemon with status 0. SIGHUP has the configuration read again between two
tests; in a terminal it ends the daemon.)");
  CLI::Option* const run =
      app.add_option("--config", options.config, "run with this configuration")->type_name("FILE");
  CLI::Option* const check = app.add_option("--check-config", options.config_to_check,
                                            "check this configuration and the files it names")
                                 ->type_name("FILE");
  CLI::Option* const finalise = app.add_option("--finalise", options.journal,
                                               "build the record of a journal (the daemon calls this itself)")
                                    ->type_name("JOURNAL");
  CLI::Option* const result =
      app.add_option("--result", options.record,
                     "print the result of a record as the broker of the fleet is told it")
          ->type_name("FILE");
  for (CLI::Option* const one : {run, check, finalise, result}) {
    for (CLI::Option* const other : {run, check, finalise, result}) {
      if (one != other) one->excludes(other);
    }
  }
  app.add_option("--scans", options.scans, "with --finalise: scans that were written to the journal")
      ->type_name("COUNT")
      ->needs(finalise);
  app.require_option(1, 2);
}

}  // namespace stickslip::daemon
