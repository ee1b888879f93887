#include "daemon/fleet/messages.hpp"

#include <optional>

#include "io/json_text.hpp"
#include "io/or_null.hpp"
#include "io/pooled_json.hpp"
#include "io/results_json.hpp"
#include <nlohmann/json.hpp>

#include "core/analysis/pooled_slips.hpp"
#include "core/analysis/skipped_corrections.hpp"
#include "core/record/iso_time.hpp"
#include "daemon/types/bench.hpp"
#include "daemon/types/plan_json.hpp"

namespace stickslip::fleet {
namespace {

using Json = nlohmann::ordered_json;

Json time_of(const std::optional<std::int64_t>& realtime_ns) {
  return realtime_ns ? Json(record::iso_time(*realtime_ns)) : Json(nullptr);
}

}  // namespace

Json result_json(const record::RecordHeader& header, const record::EndRecord& end,
                 const base::LongColumn<detect::Cycle>& cycles, const std::filesystem::path& file) {
  Json json;
  json["entry_identifier_uuid"] = header.uuid;
  json["number"] = header.test_number ? Json(*header.test_number) : Json(nullptr);
  json["start_time"] = time_of(header.start_realtime_ns);
  json["end_time"] = time_of(end.end_realtime_ns);
  json["status"] = record::name(end.status);
  json["reasons"] = end.reasons;
  json["cause"] = end.cause;
  json["file"] = file.string();
  json["plan"] = daemon::plan_json({header.sample, header.tester.pull_speed_m_per_s, {}});
  json["batch"] = io::or_null(header.sample.batch);
  json["slide"] = header.sample.slide ? Json(*header.sample.slide) : Json(nullptr);
  json["method"] = io::or_null(header.process.method);
  json["estimator"] = io::or_null(header.process.estimator);
  json["version"] = io::or_null(header.process.version);
  json["results"] = io::results_json(end.results, true);
  const analysis::SkippedCorrections skipped =
      analysis::skipped_from_text(header.process.kept).value_or(analysis::SkippedCorrections{});
  json["slips"] = io::slip_sums_json(analysis::slip_sums(cycles, skipped.first_slip));
  return json;
}

std::string result_message(const std::string& tester, const Json& result) {
  Json json{{"tester", tester}};
  json.update(result);
  return io::json_text(json);
}

std::string state_message(const std::string& tester, const daemon::Status& status, std::int64_t realtime_ns,
                          std::string_view state) {
  Json json;
  json["tester"] = tester;
  json["time"] = record::iso_time(realtime_ns);
  json["state"] = state.empty() ? std::string_view{status.state} : state;
  json["bench"] = pipeline::name(status.bench);
  json["detail"] = state.empty() ? Json(status.detail) : Json(nullptr);
  json["version"] = status.version;
  json["test_count"] = status.test_count;
  json["current_test"] = status.current_test ? Json(*status.current_test) : Json(nullptr);
  return io::json_text(json);
}

std::string last_will(const std::string& tester, std::int64_t realtime_ns) {
  return io::json_text(
      {{"tester", tester}, {"connected_since", record::iso_time(realtime_ns)}, {"state", "lost"}});
}

std::string health_message(const std::string& tester, const daemon::Status& status,
                           std::int64_t realtime_ns) {
  return io::json_text(
      {{"tester", tester}, {"time", record::iso_time(realtime_ns)}, {"status", daemon::status_json(status)}});
}

}  // namespace stickslip::fleet
