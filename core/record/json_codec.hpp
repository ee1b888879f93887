/// \file
/// The parts of a journal that are JSON, the end, which is JSON and tables, and the runs of a sweep on their
/// way. Doubles come back bit for bit: finite ones as the shortest digits that do, NaN as null, infinities
/// as "inf" and "-inf".
#pragma once

#include <cstddef>
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
/// Adds the payload of the end: JSON, a zero byte, the tables.
void append_end_bytes(const EndRecord& end, std::vector<std::byte>& bytes);
[[nodiscard]] std::string sweep_run_to_json(const SweepRun& run);

// The way back. \throws std::exception (whose what() says why) if the text is not what the function
// above writes.

[[nodiscard]] RecordHeader header_from_json(std::string_view text);
[[nodiscard]] daq::Gap gap_from_json(std::string_view text);
[[nodiscard]] detect::Cycle cycle_from_json(std::string_view text);
[[nodiscard]] Event event_from_json(std::string_view text);
/// \param bytes  may lack the tables: older journals have them in the JSON.
[[nodiscard]] EndRecord end_from_bytes(std::span<const std::byte> bytes);
[[nodiscard]] SweepRun sweep_run_from_json(std::string_view text);

}  // namespace stickslip::record
