#include <utility>

#include <nlohmann/json.hpp>

#include "core/record/reader.hpp"
#include "daemon/analyse.hpp"
#include "daemon/cli/commands.hpp"
#include "daemon/report/table.hpp"
#include "daemon/results_json.hpp"

namespace stickslip::daemon {

base::Result<std::string> run_analyze(const std::vector<std::string>& files, bool json) {
  nlohmann::ordered_json tests = nlohmann::ordered_json::array();
  std::vector<TableRow> rows;
  for (const std::string& file : files) {
    const base::Result<record::Record> record = record::read_record(file);
    if (!record) return tl::unexpected(record.error());
    base::Result<record::EndRecord> end = analyse(*record);
    if (!end) {
      return tl::unexpected(base::Error{end.error().kind, fmt::format("{}: {}", file, end.error().message)});
    }
    if (json) {
      nlohmann::ordered_json test;
      test["file"] = file;
      test.update(results_json(end->results, true));
      tests.push_back(std::move(test));
    } else {
      const auto number = static_cast<std::int64_t>(rows.size()) + 1;
      rows.push_back({record->header.test_number.value_or(number), std::move(end->results),
                      std::move(end->truth), file});
    }
  }
  if (!json) return format_table(rows);
  using Json = nlohmann::ordered_json;
  return Json{{"tests", std::move(tests)}}.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace stickslip::daemon
