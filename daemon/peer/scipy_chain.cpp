#include "daemon/peer/scipy_chain.hpp"

#include <optional>
#include <string>

#include <nlohmann/json.hpp>

#include "core/base/wording.hpp"
#include "daemon/child_process.hpp"
#include "daemon/peer/script.hpp"

namespace stickslip::daemon {
namespace {

using base::Result;
using Json = nlohmann::json;

/// Debian's, which has Debian's SciPy; the one in PATH may be another.
constexpr const char* kPython = "/usr/bin/python3";

Json json_of(std::span<const accuracy::TierScene> scenes) {
  Json json = Json::array();
  for (const accuracy::TierScene& scene : scenes) {
    json.push_back(
        {{"scan_rate", scene.scan_rate_Hz}, {"frequency", scene.frequency_Hz}, {"tests", scene.tests}});
  }
  return json;
}

}  // namespace

Result<std::vector<accuracy::PeerOutcome>> run_scipy_chain(std::span<const accuracy::TierScene> scenes) {
  const Result<std::optional<ChildAnswer>> answer =
      ask_program(kPython, {"-c", std::string{peer::scipy_chain_py()}}, json_of(scenes).dump());
  if (!answer) return tl::unexpected(answer.error());
  if (!*answer) return base::failure("not installed: there is no {}", kPython);
  if ((*answer)->errors.find("ModuleNotFoundError") != std::string::npos)
    return base::failure("not installed: {} lacks SciPy (Debian: python3-scipy)", kPython);
  const Json json = Json::parse((*answer)->output, nullptr, false);
  if ((*answer)->status != 0 || !json.is_array() || json.size() != scenes.size()) {
    constexpr std::size_t kLongestWords = 200;
    return base::failure("{} ended with status {}: {}", kPython, (*answer)->status,
                         base::one_line((*answer)->errors, kLongestWords));
  }
  std::vector<accuracy::PeerOutcome> outcomes;
  for (const Json& one : json) {
    outcomes.push_back(
        {one.at("ns_per_scan").get<double>(), one.at("differences").get<std::vector<double>>()});
  }
  return outcomes;
}

}  // namespace stickslip::daemon
