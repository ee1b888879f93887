/// \file
/// Messages to the broker, in JSON with the names of the record and of the control interface. docs/fleet.md
/// lists topics and keys.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include <nlohmann/json_fwd.hpp>

#include "core/record/record.hpp"
#include "daemon/types/status.hpp"

namespace stickslip::fleet {

/// The result of a test. A test that has just ended and its record give the same JSON, except for the status
/// of a repaired record. \param cycles  all cycles, because the end of a record that was read does not hold
/// them.
[[nodiscard]] nlohmann::ordered_json result_json(const record::RecordHeader& header,
                                                 const record::EndRecord& end,
                                                 const base::LongColumn<detect::Cycle>& cycles,
                                                 const std::filesystem::path& file);
/// The message with a result. \param result  as from result_json().
[[nodiscard]] std::string result_message(const std::string& tester, const nlohmann::ordered_json& result);

/// \param state  replaces that of `status`, unless empty. \param realtime_ns  now, ns since 1970.
[[nodiscard]] std::string state_message(const std::string& tester, const daemon::Status& status,
                                        std::int64_t realtime_ns, std::string_view state = {});
/// The MQTT will: the state that the broker publishes when the connection breaks. \param realtime_ns  time of
/// the connection, ns since 1970.
[[nodiscard]] std::string last_will(const std::string& tester, std::int64_t realtime_ns);
/// The message with the whole status.
[[nodiscard]] std::string health_message(const std::string& tester, const daemon::Status& status,
                                         std::int64_t realtime_ns);

}  // namespace stickslip::fleet
