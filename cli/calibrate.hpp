/// \file
/// `stickslip calibrate`: the gain and zero of a load cell from known weights, by a dialogue or from a file.
#pragma once

#include <iosfwd>
#include <string>

#include "core/base/result.hpp"

namespace stickslip::cli {

/// Numbers as typed, as in commands.hpp.
struct CalibrateCommand {
  std::string config;  ///< Of the daemon: its board is read. Empty: points are given.
  std::string points;  ///< Readings made elsewhere, TOML. Empty: the board is read.
  std::string folder;  ///< The history; empty: that of the configuration.
  std::string certificate;
  std::string valid_days = "365";  ///< 0: for ever.
  std::string settle = "1 s";
  std::string reading = "2 s";
  bool json = false;
};

/// \param answers  what the technician types. \param prompts  what is said in between.
/// \return what to print at the end. Errors: kFailure if the readings give no calibration; nothing is kept
/// then.
[[nodiscard]] base::Result<std::string> run_calibrate(const CalibrateCommand& command, std::istream& answers,
                                                      std::ostream& prompts);

}  // namespace stickslip::cli
