#include "io/verify.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>
#include <system_error>

#include "io/json_text.hpp"
#include "io/or_null.hpp"
#include "io/table.hpp"
#include <nlohmann/json.hpp>

#include "core/base/limited_child.hpp"

namespace stickslip::io {
namespace {

using nlohmann::ordered_json;
using record::Judgement;
using record::Verdict;

/// Verdict on a file whose reading exceeded a limit or killed the child process.
Verdict unreadable(const std::string& why) {
  Verdict verdict;
  verdict.judgement = Judgement::kDamaged;
  verdict.damage("file", why);
  return verdict;
}

/// Runs in the child process.
std::string judge_for_parent(std::string_view file, int /*memory_file*/) {
  // Names and texts of a file may be anything; JSON is UTF-8.
  return json_text(verdict_json(std::string{file}, record::judge(file)));
}

ordered_json judged(base::LimitedChild& judge, const std::string& file) {
  std::error_code ignored;
  const std::uintmax_t size = std::filesystem::file_size(file, ignored);
  const base::Result<std::string> answer = judge.ask(file, base::limits_for_file(ignored ? 0 : size));
  if (!answer) {
    Verdict verdict;
    if (answer.error().kind == base::ErrorKind::kUsage) {
      verdict = unreadable(answer.error().message);
    } else {
      verdict.note("file", answer.error().message);
    }
    return verdict_json(file, verdict);
  }
  return ordered_json::parse(*answer);
}

std::string summary(const ordered_json& verdict) {
  std::string text;
  if (verdict["kind"].is_string()) {
    text += verdict["kind"].get<std::string>();
    if (verdict["format_version"].is_number())
      text += fmt::format(" version {}", verdict["format_version"].get<std::int64_t>());
  }
  if (verdict["scans_present"].is_number())
    text += fmt::format(", {} scans", verdict["scans_present"].get<std::int64_t>());
  if (!verdict["gaps"].empty()) text += fmt::format(", {} gaps", verdict["gaps"].size());
  if (verdict["status"].is_string() && verdict["status"] != "complete")
    text += ", " + verdict["status"].get<std::string>();
  return text;
}

std::string lines(const ordered_json& verdict) {
  const std::string more = summary(verdict);
  Table file = Table::list({10, 0});
  file.add({verdict["judgement"].get<std::string>(),
            verdict["file"].get<std::string>() + (more.empty() ? "" : ": " + more)});
  Table findings = Table::list({12, 0});
  for (const ordered_json& finding : verdict["findings"]) {
    findings.add({"  " + finding["weight"].get<std::string>(),
                  finding["place"].get<std::string>() + ": " + finding["text"].get<std::string>()});
  }
  return file.text() + findings.text();
}

int exit_status_of(const ordered_json& verdict) {
  const auto judgement = verdict["judgement"].get<std::string>();
  if (judgement == record::name(Judgement::kComplete)) return kAllComplete;
  if (judgement == record::name(Judgement::kIncomplete)) return kSomeIncomplete;
  return judgement == record::name(Judgement::kDamaged) ? kSomeDamaged : kSomeNotJudged;
}

/// The worse of two exit statuses.
int worse(int a, int b) {
  constexpr std::array<int, 4> kRising{kAllComplete, kSomeIncomplete, kSomeNotJudged, kSomeDamaged};
  return std::max(std::find(kRising.begin(), kRising.end(), a),
                  std::find(kRising.begin(), kRising.end(), b))[0];
}

}  // namespace

ordered_json verdict_json(const std::string& file, const Verdict& verdict) {
  ordered_json json;
  json["file"] = file;
  json["judgement"] = record::name(verdict.judgement);
  json["kind"] = or_null(verdict.kind);
  json["format_version"] = or_null(verdict.format_version);
  json["status"] = or_null(verdict.status);
  json["scans_present"] = or_null(verdict.scans_present);
  json["scans_committed"] = or_null(verdict.scans_committed);
  json["sha256_stored"] = or_null(verdict.sha256_stored);
  json["sha256_found"] = or_null(verdict.sha256_found);
  json["gaps"] = ordered_json::array();
  for (const daq::Gap& gap : verdict.gaps) {
    json["gaps"].push_back({{"first_scan", gap.first},
                            {"scan_count", gap.count},
                            {"estimated", gap.estimated},
                            {"cause", daq::name(gap.cause)}});
  }
  json["findings"] = ordered_json::array();
  for (const record::Finding& finding : verdict.findings) {
    json["findings"].push_back(
        {{"weight", record::name(finding.weight)}, {"place", finding.place}, {"text", finding.text}});
  }
  return json;
}

VerifyOutput verify_files(const std::vector<std::string>& files, bool json) {
  VerifyOutput output;
  ordered_json all = ordered_json::array();
  base::LimitedChild judge{judge_for_parent};
  for (const std::string& file : files) {
    const ordered_json verdict = judged(judge, file);
    output.exit_status = worse(output.exit_status, exit_status_of(verdict));
    if (json) {
      all.push_back(verdict);
    } else {
      output.text += lines(verdict);
    }
  }
  if (json) output.text = json_document(ordered_json{{"files", all}});
  return output;
}

}  // namespace stickslip::io
