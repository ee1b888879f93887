/// \file
/// Shell completion, generated from the parser: commands, their options, and files for all other arguments.
#pragma once

#include <string>

#include <CLI/CLI.hpp>

namespace stickslip::manual {

/// Completion scripts, to be sourced or put into the shell's folder. \param program  name of the completed
/// program.
[[nodiscard]] std::string bash_completion(const CLI::App& app, const std::string& program);
[[nodiscard]] std::string zsh_completion(const CLI::App& app, const std::string& program);
[[nodiscard]] std::string fish_completion(const CLI::App& app, const std::string& program);

}  // namespace stickslip::manual
