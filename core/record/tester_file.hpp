/// \file
/// The characterisation of a tester as a file, kept like a calibration: `stickslip characterise` writes it,
/// `stickslip analyze --tester` reads it.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "core/analysis/characterisation.hpp"
#include "core/base/result.hpp"

namespace stickslip::record {

/// TOML with a comment on each key. \param date  ISO 8601, of the latest ring-down; empty if unknown.
[[nodiscard]] std::string tester_text(const analysis::Characterisation& characterisation,
                                      std::string_view date);

/// Errors: kUsage with file and line, as for every settings file.
[[nodiscard]] base::Result<estimate::SharedPrior::Coupling> load_tester(const std::filesystem::path& file);
/// The same from text. \param name  stands for the file in messages.
[[nodiscard]] base::Result<estimate::SharedPrior::Coupling> parse_tester(std::string_view text,
                                                                         std::string_view name);

}  // namespace stickslip::record
