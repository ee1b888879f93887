/// \file
/// Completion for shells, made from what the parser knows: commands, their options, and files for everything
/// else.
#pragma once

#include <string>

#include <CLI/CLI.hpp>

namespace stickslip::manual {

/// \param program  the word to complete after. Scripts to be sourced, or put where the shell looks for them.
[[nodiscard]] std::string bash_completion(const CLI::App& app, const std::string& program);
[[nodiscard]] std::string zsh_completion(const CLI::App& app, const std::string& program);
[[nodiscard]] std::string fish_completion(const CLI::App& app, const std::string& program);

}  // namespace stickslip::manual
