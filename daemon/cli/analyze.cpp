#include <utility>

#include <nlohmann/json.hpp>

#include "core/record/reader.hpp"
#include "daemon/analyse.hpp"
#include "daemon/cli/commands.hpp"
#include "daemon/cli/method_option.hpp"
#include "daemon/method_text.hpp"
#include "daemon/report/table.hpp"
#include "daemon/results_json.hpp"

namespace stickslip::daemon {

base::Result<std::string> run_analyze(const AnalyzeCommand& command) {
  const base::Result<friction::Method> method = chosen_method(command.method);
  if (!method) return tl::unexpected(method.error());
  nlohmann::ordered_json tests = nlohmann::ordered_json::array();
  std::vector<TableRow> rows;
  for (const std::string& file : command.files) {
    base::Result<record::Record> record = record::read_record(file);
    if (!record) return tl::unexpected(record.error());
    if (!command.method.empty()) record->header.process.method = method_text(*method);
    base::Result<record::EndRecord> end = analyse(*record);
    if (!end) {
      return tl::unexpected(base::Error{end.error().kind, fmt::format("{}: {}", file, end.error().message)});
    }
    if (command.json) {
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
  if (!command.json) return format_table(rows);
  using Json = nlohmann::ordered_json;
  return Json{{"tests", std::move(tests)}}.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace stickslip::daemon
