/// \file
/// Manual pages in the man macros of roff [man(7)], generated from the parsers, so that a page agrees with
/// --help.
#pragma once

#include <string>
#include <string_view>

#include <CLI/CLI.hpp>

namespace stickslip::manual {

/// Parts of a page that --help does not have.
struct PageFacts {
  std::string name;  ///< "stickslip".
  int section = 1;
  std::string version;  ///< "stickslip 0.1.0".
  std::string exit_status;
  std::string files;
  std::string see_also;
};

/// The page of a program with its options and subcommands, without hidden ones (those in an empty group).
[[nodiscard]] std::string command_page(const CLI::App& app, const PageFacts& facts);

/// The page of a configuration file with the form of config/stickslipd.toml. Its comments
/// "[table]   # what" and "key = value # what" become the text, also if the line is commented out by "# ".
/// Lines indented by two spaces continue a text.
[[nodiscard]] std::string config_page(std::string_view text, const PageFacts& facts);

}  // namespace stickslip::manual
