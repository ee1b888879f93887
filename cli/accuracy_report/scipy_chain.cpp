#include "cli/accuracy_report/scipy_chain.hpp"

#include <optional>
#include <string>

#include "cli/accuracy_report/script.hpp"
#include "io/child_process.hpp"
#include <nlohmann/json.hpp>

#include "core/base/wording.hpp"

namespace stickslip::accuracy_report {
namespace {

using base::Result;

/// Debian's Python, which finds Debian's SciPy; one in PATH may not.
constexpr const char* kPython = "/usr/bin/python3";

nlohmann::json json_of(std::span<const accuracy::TierScene> scenes) {
  nlohmann::json json = nlohmann::json::array();
  for (const accuracy::TierScene& scene : scenes) {
    json.push_back(
        {{"scan_rate", scene.scan_rate_Hz}, {"frequency", scene.frequency_Hz}, {"tests", scene.tests}});
  }
  return json;
}

}  // namespace

Result<std::vector<accuracy::PeerOutcome>> run_scipy_chain(std::span<const accuracy::TierScene> scenes) {
  const Result<std::optional<io::ChildAnswer>> answer =
      io::ask_program(kPython, {"-c", std::string{scipy_chain_py()}}, json_of(scenes).dump());
  if (!answer) return tl::unexpected(answer.error());
  if (!*answer) return base::failure("not installed: there is no {}", kPython);
  if ((*answer)->errors.find("ModuleNotFoundError") != std::string::npos)
    return base::failure("not installed: {} lacks SciPy (Debian: python3-scipy)", kPython);
  const nlohmann::json json = nlohmann::json::parse((*answer)->output, nullptr, false);
  if ((*answer)->status != 0 || !json.is_array() || json.size() != scenes.size()) {
    constexpr std::size_t kLongestWords = 200;
    return base::failure("{} ended with status {}: {}", kPython, (*answer)->status,
                         base::one_line((*answer)->errors, kLongestWords));
  }
  std::vector<accuracy::PeerOutcome> outcomes;
  for (const nlohmann::json& one : json) {
    outcomes.push_back(
        {one.at("ns_per_scan").get<double>(), one.at("differences").get<std::vector<double>>()});
  }
  return outcomes;
}

}  // namespace stickslip::accuracy_report
