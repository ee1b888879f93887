#include "cli/doctor_findings.hpp"

#include <utility>

#include "cli/paint.hpp"
#include "io/table.hpp"
#include <nlohmann/json.hpp>

#include "core/base/text.hpp"

namespace stickslip::cli {
namespace {

using Json = nlohmann::ordered_json;

Ink colour_of(doctor::Finding::Verdict verdict) {
  switch (verdict) {
    case doctor::Finding::Verdict::kGood:
      return Ink::kGreen;
    case doctor::Finding::Verdict::kUnknown:
      return Ink::kFaint;
    case doctor::Finding::Verdict::kWarning:
      return Ink::kYellow;
    case doctor::Finding::Verdict::kBad:
      break;
  }
  return Ink::kRed;
}

}  // namespace

Json findings_json(const std::vector<doctor::Finding>& findings) {
  Json list = Json::array();
  for (const doctor::Finding& finding : findings) {
    list.push_back({{"check", finding.check},
                    {"verdict", doctor::name(finding.verdict)},
                    {"what", finding.what},
                    {"to_do", finding.to_do.empty() ? Json(nullptr) : Json(finding.to_do)}});
  }
  return {{"exit_status", doctor::exit_status(findings)}, {"findings", std::move(list)}};
}

std::string findings_text(const std::vector<doctor::Finding>& findings, bool colours) {
  const Paint paint{colours};
  io::Table list = io::Table::list({7, 11, 0});
  for (const doctor::Finding& finding : findings) {
    list.add({paint(colour_of(finding.verdict), doctor::name(finding.verdict)), finding.check,
              base::printable(finding.what)});
    if (!finding.to_do.empty()) list.add({"", "", "→ " + base::printable(finding.to_do)});
  }
  return list.text(colours);
}

}  // namespace stickslip::cli
