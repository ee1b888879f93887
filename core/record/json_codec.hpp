/// \file
/// JSON codec of a journal's entries, of its end (JSON and tables), and of the runs of a sweep between
/// processes. Doubles of fields and columns are restored bit for bit: finite ones have the shortest
/// sufficient digits, NaN is null (its bits are lost), infinities are "inf" and "-inf". Bytes that are not
/// UTF-8 are replaced by U+FFFD.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/record/record.hpp"
#include "core/record/sweep.hpp"

namespace stickslip::record {

[[nodiscard]] std::string header_to_json(const RecordHeader& header);
[[nodiscard]] std::string gap_to_json(const daq::Gap& gap);
[[nodiscard]] std::string cycle_to_json(const detect::Cycle& cycle);
[[nodiscard]] std::string event_to_json(const Event& event);
/// Appends the payload of the end: JSON, a zero byte, the tables.
void append_end_bytes(const EndRecord& end, std::vector<std::byte>& bytes);
[[nodiscard]] std::string sweep_run_to_json(const SweepRun& run);

// Inverse functions: X_from_… of X_to_…, end_from_bytes() of append_end_bytes(). They also read the texts of
// older versions, and ignore unknown keys. \throws std::exception, with the reason in what(), if a value is
// missing or makes no sense.

/// \param format_version  takes the version that the text names, unless it is null.
[[nodiscard]] RecordHeader header_from_json(std::string_view text, std::int64_t* format_version = nullptr);
[[nodiscard]] daq::Gap gap_from_json(std::string_view text);
[[nodiscard]] detect::Cycle cycle_from_json(std::string_view text);
[[nodiscard]] Event event_from_json(std::string_view text);
/// \param bytes  may lack the tables: older journals have them in the JSON.
[[nodiscard]] EndRecord end_from_bytes(std::span<const std::byte> bytes);
[[nodiscard]] SweepRun sweep_run_from_json(std::string_view text);

}  // namespace stickslip::record
