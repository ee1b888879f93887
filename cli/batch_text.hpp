/// \file
/// How far a batch is, for people: what `stickslip batch` and `stickslip void` print.
#pragma once

#include <string>

#include "cli/ask.hpp"
#include <nlohmann/json_fwd.hpp>

#include "core/base/result.hpp"

namespace stickslip::cli {

/// \param answer  that of /v1/batch. \return it as text, or as JSON where the options say so.
[[nodiscard]] base::Result<std::string> batch_output(const BenchOptions& options,
                                                     const base::Result<nlohmann::ordered_json>& answer);

}  // namespace stickslip::cli
