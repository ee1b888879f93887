#include "core/record/json_codec.hpp"

#include <stdexcept>
#include <utility>

#include "core/record/enum_names.hpp"
#include "core/record/estimator_field.hpp"
#include "core/record/json_fields.hpp"
#include "core/record/range_check.hpp"

namespace stickslip::record {
namespace {

Metadata metadata_from(const Json& object) {
  auto metadata = object.get<Metadata>();
  if (metadata.size() > kMostMetadata)
    throw std::invalid_argument(fmt::format("metadata: {} keys, at most {}", metadata.size(), kMostMetadata));
  for (const auto& [key, value] : metadata) {
    if (const std::string refusal = metadata_refusal(key, value); !refusal.empty())
      throw std::invalid_argument("metadata: " + refusal);
  }
  return metadata;
}

}  // namespace

std::string header_to_json(const RecordHeader& header) {
  Json board = Json::object();
  for_each_name_field(header.board, putter(board));
  for_each_converter_field(header.board, putter(board));
  for_each_rate_field(header.board, putter(board));
  board["quantity"] = name(header.board.quantity).name;
  if (header.board.second) {
    board["second"] = fields_to_json(*header.board.second);
    board["second"]["quantity"] = daq::name(header.board.second->quantity);
  }

  Json object{{"format", kFormat},
              {"format_version", kFormatVersion},
              {"board", std::move(board)},
              {"calibration", fields_to_json(header.calibration)},
              {"tester", fields_to_json(header.tester)},
              {"sample", fields_to_json(header.sample)},
              {"process", fields_to_json(header.process)}};
  put(object, "uuid", header.uuid);
  put(object, "title", header.title);
  put(object, "test_number", header.test_number);
  put(object, "trigger_scan", header.trigger_scan);
  put(object, "start_realtime_ns", header.start_realtime_ns);
  put(object, "operator", header.sample.operator_name);
  if (!header.sample.metadata.empty()) object["metadata"] = header.sample.metadata;
  if (header.load_cell) object["load_cell"] = fields_to_json(*header.load_cell);
  if (const Json plan = fields_to_json(header.plan); !plan.empty()) object["plan"] = plan;
  if (header.self_check) {
    object["self_check"] = fields_to_json(*header.self_check);
    put(object["self_check"], "raw", header.self_check->raw);
  }
  return dump(object);
}

RecordHeader header_from_json(std::string_view text, std::int64_t* format_version) {
  const Json object = Json::parse(text);
  if (object.at("format") != kFormat) {
    throw std::invalid_argument(
        fmt::format("format {}, this program reads {}", object.at("format").dump(), kFormat));
  }
  const auto version = decoded<std::int64_t>(object.at("format_version"));
  if (const std::string refusal = version_refusal(version); !refusal.empty())
    throw std::invalid_argument(refusal);
  if (format_version) *format_version = version;
  RecordHeader header;
  const Json& board = object.at("board");
  for_each_name_field(header.board, taker(board));
  for_each_converter_field(header.board, taker(board));
  for_each_rate_field(header.board, taker(board));
  const auto quantity = board.at("quantity").get<std::string>();
  header.board.quantity = word(quantity, quantity_from_name(quantity));
  if (board.contains("second")) {
    daq::SecondChannel& second = header.board.second.emplace();
    const auto measured = board.at("second").at("quantity").get<std::string>();
    second.quantity = word(measured, daq::second_quantity_from_name(measured));
    for_each_field(second, taker(board.at("second")));
  }
  for_each_field(header.calibration, taker(object.at("calibration")));
  for_each_field(header.tester, taker(object.at("tester")));
  for_each_field(header.sample, taker(object.at("sample")));
  for_each_field(header.process, taker(object.at("process")));
  read_estimator_of_0_1(header.process);
  take(object, "uuid", header.uuid);
  take(object, "title", header.title);
  take(object, "test_number", header.test_number);
  take(object, "trigger_scan", header.trigger_scan);
  take(object, "start_realtime_ns", header.start_realtime_ns);
  take(object, "operator", header.sample.operator_name);
  if (object.contains("metadata")) header.sample.metadata = metadata_from(object.at("metadata"));
  if (object.contains("load_cell")) {
    for_each_field(header.load_cell.emplace(), taker(object.at("load_cell")));
  }
  if (object.contains("plan")) for_each_field(header.plan, taker(object.at("plan")));
  if (object.contains("self_check")) {
    const Json& check = object.at("self_check");
    for_each_field(header.self_check.emplace(), taker(check));
    take(check, "raw", header.self_check->raw);
  }
  return header;
}

std::string gap_to_json(const daq::Gap& gap) {
  return dump({{"first_scan", gap.first},
               {"scan_count", gap.count},
               {"estimated", gap.estimated},
               {"cause", daq::name(gap.cause)}});
}

daq::Gap gap_from_json(std::string_view text) {
  const Json object = Json::parse(text);
  const auto cause = object.at("cause").get<std::string>();
  return range_checked(daq::Gap{decoded<daq::ScanIndex>(object.at("first_scan")),
                                decoded<std::int64_t>(object.at("scan_count")),
                                object.at("estimated").get<bool>(), word(cause, gap_cause_from_name(cause))});
}

std::string cycle_to_json(const detect::Cycle& cycle) { return dump(cycle_to_array(cycle)); }

detect::Cycle cycle_from_json(std::string_view text) { return cycle_from_array(Json::parse(text)); }

std::string event_to_json(const Event& event) {
  return dump({{"scan", event.scan}, {"realtime_ns", event.realtime_ns}, {"text", event.text}});
}

Event event_from_json(std::string_view text) {
  const Json object = Json::parse(text);
  return {range_checked(decoded<daq::ScanIndex>(object.at("scan"))),
          decoded<std::int64_t>(object.at("realtime_ns")), object.at("text").get<std::string>()};
}

}  // namespace stickslip::record
