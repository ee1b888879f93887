/// \file
/// Manual pages in the man macros of roff [man(7)], made from what the programs know of themselves: a page
/// cannot say otherwise than --help does.
#pragma once

#include <string>
#include <string_view>

#include <CLI/CLI.hpp>

namespace stickslip::manual {

/// What --help does not hold.
struct PageFacts {
  std::string name;  ///< "stickslip".
  int section = 1;
  std::string version;  ///< "stickslip 0.1.0".
  std::string exit_status;
  std::string files;
  std::string see_also;
};

/// Of a program with its options and subcommands; hidden ones (of an empty group) are left out.
[[nodiscard]] std::string command_page(const CLI::App& app, const PageFacts& facts);

/// Of a configuration file that documents itself as config/stickslipd.toml does: "[table]   # what", "key =
/// value # what" or the same behind "# ", with lines that go on behind two spaces.
[[nodiscard]] std::string config_page(std::string_view text, const PageFacts& facts);

}  // namespace stickslip::manual
