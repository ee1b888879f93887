/// \file
/// The shipped analysis over a record in memory: the same walk as live, so the same bits.
#pragma once

#include "core/base/result.hpp"
#include "core/record/record.hpp"

namespace stickslip::daemon {

/// Results, cycles and spikes of the record's scans; status, cause and truth stay those of the
/// record's end, if it has one.
/// Errors: kUsage if the record's facts do not allow it (no scan rate, no load cell for counts).
[[nodiscard]] base::Result<record::EndRecord> analyse(const record::Record& record);

}  // namespace stickslip::daemon
