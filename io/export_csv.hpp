/// \file
/// A record as CSV, for spreadsheets. Numbers read back to the same bits.
#pragma once

#include <string>

#include "core/record/record.hpp"

namespace stickslip::io {

/// The scans as CSV: comment lines (#) with the facts of the record, a header whose names end in their units,
/// and one row for each scan that arrived. The columns are time_s, scan, the raw value, what follows from it
/// as far as it is known (voltage_V, force_N, coefficient), codes and values of a second channel
/// (pull_speed_counts, pull_speed_m_per_s or sled_position_counts, sled_position_m; empty where no code
/// came), spike and saturated (0 or 1). Scans in gaps have no row. Lines of fact_line.hpp above and below the
/// rows hold what else traces::read_own_table() needs to make the record again.
[[nodiscard]] std::string scans_csv(const record::Record& record);

/// The cycles as CSV, with the same comment lines and one row for each cycle. An unknown number is an empty
/// field.
[[nodiscard]] std::string cycles_csv(const record::Record& record);

}  // namespace stickslip::io
