// Any request that HTTP lets through is answered once, with a status that is described and in JSON.

#include <fuzzer/FuzzedDataProvider.h>

#include <array>
#include <set>

#include <nlohmann/json.hpp>

#include "core/base/contract.hpp"
#include "daemon/control/api.hpp"
#include "tests/support/manual_clock.hpp"
#include "tests/unit/paper_bench.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace stickslip;
  static const std::set<int> described{200, 400, 404, 405, 409, 422, 507};
  FuzzedDataProvider input{data, size};
  daemon::PaperBench bench;
  test::ManualClock clock;
  const daemon::HttpHandler api = daemon::make_api(bench, clock);
  while (input.remaining_bytes() > 0) {
    static constexpr std::array kMethods{"GET", "PUT", "POST", "DELETE", "PATCH"};
    static constexpr std::array kPaths{"/v1/plan",
                                       "/v1/start",
                                       "/v1/stop",
                                       "/v1/mark",
                                       "/v1/arm",
                                       "/v1/tests",
                                       "/v1/tests/7",
                                       "/v1/tare",
                                       "/v1/batch",
                                       "/v1/void",
                                       "/v1/restore",
                                       "/v1/controller",
                                       "/v1/calibration",
                                       "/v1/calibration/weight",
                                       "/v1/calibration/undo",
                                       "/v1/calibration/finish"};
    daemon::HttpRequest request;
    request.method = input.PickValueInArray(kMethods);
    request.target = input.ConsumeBool() ? std::string{input.PickValueInArray(kPaths)}
                                         : input.ConsumeRandomLengthString(80);
    request.controller = input.ConsumeBool() ? "ada" : input.ConsumeRandomLengthString(80);
    request.idempotency_key = input.ConsumeBool() ? "" : input.ConsumeRandomLengthString(140);
    request.body = input.ConsumeRandomLengthString();
    int answers = 0;
    api(request, [&](const daemon::HttpReply& reply) {
      ++answers;
      STICKSLIP_EXPECTS(described.contains(reply.status));
      STICKSLIP_EXPECTS(reply.content_type != "application/json" || nlohmann::json::accept(reply.body));
    });
    STICKSLIP_EXPECTS(answers == 1);
  }
  return 0;
}
