/// \file
/// A record as tables of text, for spreadsheets. Numbers have all their digits: read back they are the same
/// to the last bit.
#pragma once

#include <string>

#include "core/record/record.hpp"

namespace stickslip::io {

/// Lines that begin with # and tell the facts, a header whose names end in their units, one row for each scan
/// that arrived: time_s, scan, the raw value, what follows from it (voltage_V, force_N, coefficient, as far
/// as known), codes and values of a second channel (pull_speed_counts, pull_speed_m_per_s or
/// sled_position_counts, sled_position_m; empty where none came), spike and saturated (0 or 1). What is
/// missing is missing.
[[nodiscard]] std::string scans_csv(const record::Record& record);

/// The same of the cycles; a number that is not known is an empty field.
[[nodiscard]] std::string cycles_csv(const record::Record& record);

}  // namespace stickslip::io
