/// \file
/// The parts of a journal that are JSON. Doubles come back bit for bit: finite ones as the shortest
/// digits that do, NaN as null, infinities as "inf" and "-inf".
#pragma once

#include <string>
#include <string_view>

#include "core/record/record.hpp"

namespace stickslip::record {

[[nodiscard]] std::string header_to_json(const RecordHeader& header);
[[nodiscard]] std::string gap_to_json(const daq::Gap& gap);
[[nodiscard]] std::string cycle_to_json(const friction::Cycle& cycle);
[[nodiscard]] std::string event_to_json(const Event& event);
[[nodiscard]] std::string end_to_json(const EndRecord& end);

// The way back. \throws std::exception (whose what() says why) if the text is not what the function
// above writes.

[[nodiscard]] RecordHeader header_from_json(std::string_view text);
[[nodiscard]] daq::Gap gap_from_json(std::string_view text);
[[nodiscard]] friction::Cycle cycle_from_json(std::string_view text);
[[nodiscard]] Event event_from_json(std::string_view text);
[[nodiscard]] EndRecord end_from_json(std::string_view text);

}  // namespace stickslip::record
