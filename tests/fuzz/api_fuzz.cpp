// Any request that HTTP lets through is answered once, with a status that is described and in JSON.

#include <fuzzer/FuzzedDataProvider.h>

#include <array>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <boost/algorithm/string/replace.hpp>
#include <nlohmann/json.hpp>

#include "core/base/contract.hpp"
#include "daemon/control/api.hpp"
#include "daemon/control/openapi.hpp"
#include "tests/support/manual_clock.hpp"
#include "tests/unit/paper_bench.hpp"

namespace {

using namespace stickslip;

/// All paths that are described, with what a paper bench has in the place of names; and some with queries.
std::vector<std::string> known_targets() {
  std::vector<std::string> targets;
  const nlohmann::json description = nlohmann::json::parse(control::openapi());
  for (const auto& [path, methods] : description.at("paths").items()) {
    std::string target = path;
    constexpr std::array<std::pair<const char*, const char*>, 3> kNames{
        {{"{number}", "7"}, {"{name}", "20261121T125252Z-0007.h5"}, {"{id}", "20261122T180301Z"}}};
    for (const auto& [parameter, value] : kNames) boost::replace_all(target, parameter, value);
    targets.push_back(std::move(target));
  }
  for (const char* target : {
           "/v1/batches/20261122T180301Z/report?format=csv",
           "/v1/batches/20261122T180302Z/report?format=json",
           "/v1/batches/20261122T180301Z/report?format=",
           "/v1/batches/..%2f..%2fetc/report",
           "/v1/compare?a=20261122T180301Z&b=20261122T180302Z",
           "/v1/compare?a=20261122T180301Z&b=20261122T180302Z&format=csv",
           "/v1/compare?a=20261122T180301Z&a=20261122T180301Z",
           "/v1/records/../20261121T125252Z-0007.h5",
           "/v1/tests/99999999999999999999",
       }) {
    targets.emplace_back(target);
  }
  return targets;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const std::set<int> described{200, 400, 404, 405, 409, 422, 507};
  static const std::vector<std::string> targets = known_targets();
  FuzzedDataProvider input{data, size};
  daemon::PaperBench bench;
  test::ManualClock clock;
  control::Lease lease;
  const daemon::HttpHandler api = control::make_api(bench, clock, lease);
  while (input.remaining_bytes() > 0) {
    static constexpr std::array kMethods{"GET", "PUT", "POST", "DELETE", "PATCH"};
    daemon::HttpRequest request;
    request.method = input.PickValueInArray(kMethods);
    request.target = input.ConsumeBool()
                         ? targets[input.ConsumeIntegralInRange<std::size_t>(0, targets.size() - 1)]
                         : input.ConsumeRandomLengthString(80);
    request.controller = input.ConsumeBool() ? "ada" : input.ConsumeRandomLengthString(80);
    request.idempotency_key = input.ConsumeBool() ? "" : input.ConsumeRandomLengthString(140);
    request.body = input.ConsumeRandomLengthString();
    int answers = 0;
    api(request, [&](const daemon::HttpReply& reply) {
      ++answers;
      STICKSLIP_EXPECTS(described.contains(reply.status));
      // The description is long, always the same, and was read above.
      STICKSLIP_EXPECTS(reply.content_type != "application/json" || reply.body == control::openapi() ||
                        nlohmann::json::accept(reply.body));
    });
    STICKSLIP_EXPECTS(answers == 1);
  }
  return 0;
}
