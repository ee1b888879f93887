// Whatever a record says, what the broker is told of it is one object of JSON in UTF-8, which the next
// program reads as its own; and what a process says of a record is a result or is passed over.

#include <fuzzer/FuzzedDataProvider.h>

#include <bit>
#include <string>

#include <nlohmann/json.hpp>

#include "core/base/contract.hpp"
#include "daemon/fleet/backlog.hpp"
#include "daemon/fleet/messages.hpp"

namespace {

using namespace stickslip;

std::string text(FuzzedDataProvider& input) { return input.ConsumeRandomLengthString(40); }

void say_result(FuzzedDataProvider& input) {
  const auto number = [&input] { return std::bit_cast<double>(input.ConsumeIntegral<std::uint64_t>()); };
  const std::string tester = text(input);
  record::RecordHeader header;
  header.uuid = text(input);
  header.sample.name = text(input);
  header.sample.grade = text(input);
  header.sample.operator_name = text(input);
  header.process.method = text(input);
  header.process.version = text(input);
  header.tester.pull_speed_m_per_s = number();
  if (input.ConsumeBool()) header.test_number = input.ConsumeIntegral<std::int64_t>();
  header.start_realtime_ns = input.ConsumeIntegral<std::int64_t>();
  record::EndRecord end;
  end.cause = text(input);
  end.reasons = {text(input), text(input)};
  end.end_realtime_ns = input.ConsumeIntegral<std::int64_t>();
  end.results = record::absent_results(text(input));
  analysis::for_each_result(end.results, [&](const analysis::ResultName&, analysis::Estimate& estimate) {
    if (input.ConsumeBool()) estimate = analysis::Estimate::of(number(), number());
  });
  const auto result = fleet::result_json(header, end, end.cycles, text(input));
  const std::string message = fleet::result_message(tester, result);
  STICKSLIP_EXPECTS(message.find('\n') == std::string::npos);
  const auto read = nlohmann::json::parse(message, nullptr, false);
  STICKSLIP_EXPECTS(read.is_object() && read.contains("tester") && read.contains("results"));
}

void say_state(FuzzedDataProvider& input) {
  const std::string tester = text(input);
  daemon::Status status;
  status.state = text(input);
  status.detail = text(input);
  status.version = text(input);
  status.storage.why = text(input);
  const auto now_ns = input.ConsumeIntegral<std::int64_t>();
  for (const std::string& said :
       {fleet::state_message(tester, status, now_ns), fleet::last_will(tester, now_ns),
        fleet::health_message(tester, status, now_ns)}) {
    STICKSLIP_EXPECTS(nlohmann::json::accept(said));
  }
}

void hear_result(FuzzedDataProvider& input) {
  const std::string tester = text(input);
  const auto result = fleet::parse_result("20261122T101500Z", tester, input.ConsumeRemainingBytesAsString());
  STICKSLIP_EXPECTS(!result || nlohmann::json::accept(result->payload));
  STICKSLIP_EXPECTS(!result || result->id.find('/') == std::string::npos);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  FuzzedDataProvider input{data, size};
  switch (input.ConsumeIntegralInRange<int>(0, 2)) {
    case 0:
      say_result(input);
      break;
    case 1:
      say_state(input);
      break;
    default:
      hear_result(input);
  }
  return 0;
}
