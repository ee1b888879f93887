/// \file
/// What the broker is told, as JSON: names as in the record and over HTTP. docs/fleet.md lists topics and
/// keys.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include <nlohmann/json_fwd.hpp>

#include "core/record/record.hpp"
#include "daemon/types/status.hpp"

namespace stickslip::fleet {

/// One test. The same for a test that has just ended and for its record, but for the status of one that was
/// repaired on the way. \param cycles  all: those of a record that was read do not stand in its end.
[[nodiscard]] nlohmann::ordered_json result_json(const record::RecordHeader& header,
                                                 const record::EndRecord& end,
                                                 const base::LongColumn<detect::Cycle>& cycles,
                                                 const std::filesystem::path& file);
/// That of a tester. \param result  result_json().
[[nodiscard]] std::string result_message(const std::string& tester, const nlohmann::ordered_json& result);

/// \param state  instead of the status's, unless empty.
[[nodiscard]] std::string state_message(const std::string& tester, const daemon::Status& status,
                                        std::int64_t realtime_ns, std::string_view state = {});
/// What others are told when the tester is heard of no more. \param realtime_ns  when it was connected.
[[nodiscard]] std::string last_will(const std::string& tester, std::int64_t realtime_ns);
/// The whole status.
[[nodiscard]] std::string health_message(const std::string& tester, const daemon::Status& status,
                                         std::int64_t realtime_ns);

}  // namespace stickslip::fleet
