// Subcommand that calibrates: calibrate.

#include <iostream>

#include "cli/calibrate.hpp"
#include "cli/subcommands.hpp"

namespace stickslip::cli {
namespace {

constexpr const char* kCalibrateExamples =
    R"(Hang known weights on the load cell: nothing first, then at least three, each heavier, then the same way down.
A straight line by least squares gives gain and zero with their standard errors. A reading that cannot count
(saturated, unstable, no change from the tare, less than 1 % of the range) is named with the reason. Each
calibration is a file of its own, named by its date, and stays as it is; [tester] calibration in the daemon's
configuration names the folder, and the latest goes into each record.

Examples:
  stickslip calibrate --config /etc/stickslip/stickslipd.toml --certificate "DKD-1234"
  stickslip calibrate --points readings.toml --folder calibrations --valid-days 180

A file of readings: [[point]] tables with mass = "500 g" and voltage = "1.25 V", the tare first; if known
standard_error and wander (volts), saturated = true.)";

}  // namespace

void add_calibrating_commands(CLI::App& app, Chosen& chosen) {
  const auto kept = std::make_shared<CalibrateCommand>();
  CalibrateCommand& command = *kept;
  CLI::App* calibrate = app.add_subcommand("calibrate", "gain and zero of a load cell from known weights");
  calibrate->footer(kCalibrateExamples);
  calibrate->add_option("--config", command.config, "of the daemon, which must not run: its board is read")
      ->type_name("FILE.toml");
  calibrate->add_option("--points", command.points, "readings made elsewhere instead")
      ->type_name("FILE.toml");
  calibrate->add_option("--folder", command.folder, "of the calibrations; else [tester] calibration")
      ->type_name("DIR");
  calibrate->add_option("--certificate", command.certificate, "of the weights")->type_name("TEXT");
  calibrate->add_option("--valid-days", command.valid_days, "until a new one is due; 0: for ever")
      ->capture_default_str()
      ->type_name("N");
  calibrate->add_option("--settle", command.settle, "left for a weight to come to rest")
      ->capture_default_str()
      ->type_name("T");
  calibrate->add_option("--reading", command.reading, "for which each weight is read")
      ->capture_default_str()
      ->type_name("T");
  calibrate->add_flag("--json", command.json, "JSON instead of text");
  choose(*calibrate, chosen, [kept] { return run_calibrate(*kept, std::cin, std::cerr); });
}

}  // namespace stickslip::cli
