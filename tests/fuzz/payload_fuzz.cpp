// Whatever a record says, what the broker is told of it is one object of JSON in UTF-8, which the next program reads as its
// own; and what another program left in the outbox is a result or is passed over.

#include <fuzzer/FuzzedDataProvider.h>

#include <bit>
#include <string>

#include <nlohmann/json.hpp>

#include "core/base/contract.hpp"
#include "daemon/fleet/backlog.hpp"
#include "daemon/fleet/messages.hpp"
#include "tests/support/record_samples.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace stickslip;
  FuzzedDataProvider input{data, size};
  const auto text = [&input] { return input.ConsumeRandomLengthString(40); };
  const auto number = [&input] { return std::bit_cast<double>(input.ConsumeIntegral<std::uint64_t>()); };
  const std::string tester = text();
  record::RecordHeader header;
  header.uuid = text();
  header.sample.name = text();
  header.sample.grade = text();
  header.sample.operator_name = text();
  header.process.method = text();
  header.process.version = text();
  header.tester.pull_speed_m_per_s = number();
  if (input.ConsumeBool()) header.test_number = input.ConsumeIntegral<std::int64_t>();
  header.start_realtime_ns = input.ConsumeIntegral<std::int64_t>();
  record::EndRecord end;
  end.cause = text();
  end.reasons = {text(), text()};
  end.end_realtime_ns = input.ConsumeIntegral<std::int64_t>();
  end.results = record::absent_results(text());
  friction::for_each_result(end.results, [&](const friction::ResultName&, friction::Estimate& estimate) {
    if (input.ConsumeBool()) estimate = friction::Estimate::of(number(), number());
  });
  const auto result = daemon::result_json(header, end, text());
  const std::string message = daemon::result_message(tester, result);
  STICKSLIP_EXPECTS(message.find('\n') == std::string::npos);
  const auto read = nlohmann::json::parse(message, nullptr, false);
  STICKSLIP_EXPECTS(read.is_object() && read.contains("tester") && read.contains("results"));

  daemon::Status status;
  status.state = text();
  status.detail = text();
  status.version = text();
  status.storage.why = text();
  const auto now_ns = input.ConsumeIntegral<std::int64_t>();
  for (const std::string& said : {daemon::state_message(tester, status, now_ns), daemon::last_will(tester, now_ns),
                                  daemon::health_message(tester, status, now_ns)}) {
    STICKSLIP_EXPECTS(nlohmann::json::accept(said));
  }
  const auto answered = daemon::parse_result("20261122T101500Z", tester, input.ConsumeRemainingBytesAsString());
  STICKSLIP_EXPECTS(!answered || nlohmann::json::accept(answered->payload));
  STICKSLIP_EXPECTS(!answered || answered->id.find('/') == std::string::npos);
  return 0;
}
