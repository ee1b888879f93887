#include "daemon/fleet/backlog.hpp"

#include <utility>

#include "io/json_text.hpp"
#include <nlohmann/json.hpp>

#include "core/record/read_apart.hpp"
#include "daemon/fleet/messages.hpp"
#include "daemon/types/record_result.hpp"

namespace stickslip::fleet {

std::optional<FleetResult> ask_result(const std::string& program, const std::string& tester,
                                      const std::filesystem::path& record) {
  const auto result = daemon::result_of(program, record);
  if (!result) return std::nullopt;
  return parse_result(record.stem().string(), tester, result->dump());
}

std::optional<FleetResult> parse_result(const std::string& record, const std::string& tester,
                                        const std::string& printed) {
  const auto json = nlohmann::ordered_json::parse(printed, nullptr, false);
  if (!json.is_object()) return std::nullopt;
  const auto id = json.find("entry_identifier_uuid");
  if (id == json.end() || !id->is_string()) return std::nullopt;
  // The outbox names a file by it, and anybody may have written the record.
  const auto& uuid = id->get_ref<const std::string&>();
  if (uuid.empty() || uuid.find_first_not_of("0123456789abcdefABCDEF-") != std::string::npos)
    return std::nullopt;
  return FleetResult{record, uuid, result_message(tester, json)};
}

base::Result<std::string> result_of_record(const std::filesystem::path& file) {
  const base::Result<record::Record> record = record::read_record_apart(file);
  if (!record) return tl::unexpected(record.error());
  if (!record->end) return base::usage_error("{}: holds no end of a test", file.string());
  return io::json_text(result_json(record->header, *record->end, record->cycles, file)) + "\n";
}

}  // namespace stickslip::fleet
