/// \file
/// The subcommands of `stickslip`. Each returns what to print on stdout, or an error; nothing is
/// printed and no file is left before all of it has succeeded.
#pragma once

#include <string>
#include <vector>

#include "core/base/result.hpp"

namespace stickslip::daemon {

/// Numbers as typed: "350", "350 Hz", "12 in/min"; bare numbers are in SI units.
struct ImportCommand {
  std::string csv;
  std::string column;
  std::string time_column;
  std::string rate;
  std::string unit;  ///< "coefficient", "N" or "V".
  std::string speed;
  std::string sled_mass;
  std::string stiffness;
  std::string load_cell_gain;
  std::string load_cell_zero;
  std::string output;
};

[[nodiscard]] base::Result<std::string> run_import(const ImportCommand& command);

[[nodiscard]] base::Result<std::string> run_analyze(const std::vector<std::string>& files, bool json);

/// Numbers as typed, as above.
struct SimulateCommand {
  std::string scene;  ///< File, or name of a shipped scene.
  std::string output;
  std::string folder;                ///< Of the shipped scenes; empty: where the program finds them.
  std::string seed;                  ///< Empty: that of the scene.
  std::vector<std::string> without;  ///< Effects.
  std::vector<std::string> set;      ///< "key=value"
  std::string rate;
  std::string duration;
  bool json = false;
  std::string line;  ///< The whole command, for the record.
};

[[nodiscard]] base::Result<std::string> run_simulate(const SimulateCommand& command);

/// \param folder  as in SimulateCommand.
[[nodiscard]] base::Result<std::string> run_scenes(const std::string& folder, bool json);

[[nodiscard]] base::Result<std::string> run_status(const std::string& socket);

}  // namespace stickslip::daemon
