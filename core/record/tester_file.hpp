/// \file
/// File of a tester's characterisation. `stickslip characterise` writes it, `stickslip analyze --tester`
/// reads it.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "core/analysis/characterisation.hpp"
#include "core/base/result.hpp"

namespace stickslip::record {

/// Text of the file: TOML with comments. ω and γ/2ω have 10 digits, their standard errors and correlation 6,
/// so that load_tester() gives rounded values.
/// \param date  ISO 8601, of the latest ring-down; empty if unknown.
[[nodiscard]] std::string tester_text(const analysis::Characterisation& characterisation,
                                      std::string_view date);

/// Reads ω and γ/2ω with their covariance from a characterisation file. Errors: kUsage, with file and, for an
/// error in the text, line.
[[nodiscard]] base::Result<estimate::SharedPrior::Coupling> load_tester(const std::filesystem::path& file);
/// As load_tester(), from the text of a file. \param name  stands for the file in messages.
[[nodiscard]] base::Result<estimate::SharedPrior::Coupling> parse_tester(std::string_view text,
                                                                         std::string_view name);

}  // namespace stickslip::record
