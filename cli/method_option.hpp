/// \file
/// The option --method.
#pragma once

#include <string>

#include <CLI/CLI.hpp>

#include "core/base/result.hpp"
#include "core/model/method.hpp"

namespace stickslip::cli {

void add_method_option(CLI::App& command, std::string& method);

/// The method of a file, or a shipped one by its name; penner-1995 if nothing was given.
/// Usage error that names the option, or the file with the line.
[[nodiscard]] base::Result<model::Method> chosen_method(const std::string& given);

}  // namespace stickslip::cli
