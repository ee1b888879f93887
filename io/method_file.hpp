/// \file
/// Test methods as TOML files; config/methods/ has the shipped ones, penner-1995.toml each key.
///
///     Result<MethodFile> file = load_method("config/methods/iso-8295.toml");
///     if (!file) return tl::unexpected(file.error());   // one line: file, line, key, value, what is allowed
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/result.hpp"
#include "core/base/settings.hpp"
#include "core/model/method.hpp"

namespace stickslip::io {

/// Largest number of kinetic cycles that a method may ask for.
inline constexpr int kMostKineticCycles = 1000;
/// Largest number of the slip at which a method may read the static coefficient.
inline constexpr int kLastStaticSlip = 1000;

struct MethodFile {
  model::Method method;
  std::string description;         ///< One line.
  std::vector<std::string> check;  ///< What the user must compare with their copy of a standard.
};

/// Reads a method file. Errors: kUsage, as base::Settings.
[[nodiscard]] base::Result<MethodFile> load_method(const std::filesystem::path& file);

/// Reads a method from text. \param name  stands for the file in messages. Errors: kUsage.
[[nodiscard]] base::Result<MethodFile> parse_method(std::string_view text, std::string_view name);

/// True if the text can name a method: lower-case letters, digits and hyphens.
[[nodiscard]] bool is_method_name(std::string_view text);

}  // namespace stickslip::io
