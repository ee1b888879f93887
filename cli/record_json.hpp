/// \file
/// A record as JSON: its facts and results, without scans.
#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

#include "core/record/record.hpp"

namespace stickslip::cli {

/// What `stickslip show FILE.h5 --json` prints. \param file  as the user named it. \param record  has an end
/// (contract); its scans are not needed.
[[nodiscard]] nlohmann::ordered_json record_json(const std::string& file, const record::Record& record);

}  // namespace stickslip::cli
