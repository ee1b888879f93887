#include <fmt/format.h>

#include <chrono>
#include <cstdint>
#include <memory>
#include <string>

#include "cli/json_members.hpp"
#include "cli/paint.hpp"
#include "cli/subcommands.hpp"
#include "io/findings_text.hpp"
#include "io/json_text.hpp"
#include "io/table.hpp"
#include <nlohmann/json.hpp>

#include "core/base/text.hpp"
#include "core/record/finding_json.hpp"
#include "daemon/client/client.hpp"

namespace stickslip::cli {
namespace {

using Json = nlohmann::ordered_json;

struct StatusOptions {
  std::string socket = "/run/stickslip/control.sock";
  bool json = false;
};

std::int64_t count(const Json& json, const char* key) {
  const auto found = json.find(key);
  return found != json.end() && found->is_number_integer() ? found->get<std::int64_t>() : 0;
}

/// An object, empty if there is none.
Json part(const Json& json, const char* key) {
  const auto found = json.find(key);
  return found != json.end() && found->is_object() ? *found : Json::object();
}

Ink of_state(const std::string& state) {
  if (state == "acquiring") return Ink::kGreen;
  if (state == "starting" || state == "stopping") return Ink::kYellow;
  return Ink::kRed;
}

Ink of_bench(const std::string& bench) {
  if (bench == "idle") return Ink::kNone;
  if (bench == "degraded") return Ink::kRed;
  return bench == "armed" ? Ink::kYellow : Ink::kGreen;
}

/// As the page has them: each by word first, colour helps.
Ink of_regime(const std::string& regime) {
  if (regime == "stick-slip") return Ink::kBlue;
  if (regime == "ring-down" || regime == "inertial-oscillation") return Ink::kYellow;
  return regime == "steady-sliding" ? Ink::kGreen : Ink::kNone;
}

struct Lines {
  Paint paint{wants_colours()};
  io::Table list = io::Table::list({8, 0});

  /// \param text  printable; its own colours stay where the line has none.
  void line(const char* what, const std::string& text, Ink colour = Ink::kNone) {
    list.add({paint(Ink::kFaint, what), colour == Ink::kNone ? text : paint(colour, text)});
  }
};

void board(Lines& lines, const Json& status) {
  const Json board = part(status, "board");
  if (board.empty()) return lines.line("board", "none", Ink::kRed);
  const Json measured = part(status, "scan_rate_measured");
  const double granted_Hz = board.value("scan_rate_granted", 0.0);
  std::string text = fmt::format("{} ({}), {} Hz", word(board, "name"), word(board, "driver"),
                                 number(board, "scan_rate_granted", 2));
  if (!measured.empty() && granted_Hz > 0.0) {
    text += fmt::format(", by this computer's clock {:+.0f} ppm",
                        1e6 * (measured.value("value", granted_Hz) / granted_Hz - 1.0));
  }
  lines.line("board", text);
}

void tests(Lines& lines, const Json& status) {
  const Json live = part(status, "live");
  if (status.contains("current_test") && status["current_test"].is_number()) {
    const std::string regime = word(live, "regime");
    lines.line("test",
               fmt::format("{}: {}, {}, {} slips, S - K {}", status["current_test"].dump(),
                           word(live, "phase"), lines.paint(of_regime(regime), regime),
                           count(live, "slip_count"), number(part(live, "latest_cycle"), "delta_mu", 4)));
  }
  const Json latest = part(status, "latest_test");
  if (latest.empty()) return lines.line("latest", "no test has ended");
  const Json results = part(latest, "results");
  const std::string regime = word(results, "regime");
  lines.line("latest",
             fmt::format("test {}: {}, S - K {}, S {}, K {}, {} cycles; {}", count(latest, "number"),
                         lines.paint(of_regime(regime), regime), coefficient(results, "delta_mu"),
                         coefficient(results, "mu_s"), coefficient(results, "mu_k"),
                         number(results, "cycle_count", 0), word(latest, "file")));
}

/// \param of  the status, or the results of a test.
void findings(Lines& lines, const Json& of) {
  for (const base::Finding& finding : record::findings_in(of)) {
    lines.line("finding", base::printable(finding.text),
               finding.severity == base::Severity::kFault ? Ink::kRed : Ink::kYellow);
    lines.line("", "→ " + io::action_text(finding));
  }
}

std::string text_of(const Json& status) {
  Lines lines;
  const std::string state = word(status, "state");
  const std::string bench = word(status, "bench");
  lines.line("state", state, of_state(state));
  lines.line("bench", bench, of_bench(bench));
  lines.line("detail", word(status, "detail"));
  board(lines, status);
  const Json scans = part(status, "scans");
  const std::int64_t lost = count(scans, "in_gaps");
  lines.line("scans",
             fmt::format("{}: {} in records, {} between tests, {} under way; {} lost in {} gaps, {} overruns",
                         count(status, "scan_count"), count(scans, "recorded"), count(scans, "idle"),
                         count(scans, "under_way"), lost, count(status, "gap_count"),
                         count(status, "overrun_count")),
             lost > 0 ? Ink::kYellow : Ink::kNone);
  tests(lines, status);
  lines.line("tests", fmt::format("{} ended", count(status, "test_count")));
  const Json storage = part(status, "storage");
  const bool stored = word(storage, "state") == "ok";
  lines.line("storage",
             stored ? fmt::format("ok{}", storage.contains("room_h") && storage["room_h"].is_number()
                                              ? fmt::format(", room for {} h", number(storage, "room_h", 0))
                                              : "")
                    : fmt::format("{}: {}; {}", word(storage, "state"), word(storage, "why"),
                                  word(storage, "to_do")),
             stored ? Ink::kNone : Ink::kRed);
  if (const auto lacks = storage.find("lacks"); lacks != storage.end()) {
    for (const Json& lack : *lacks)
      lines.line("lacks", lack.is_string() ? base::printable(lack.get<std::string>()) : "");
  }
  findings(lines, status);
  findings(lines, part(part(status, "latest_test"), "results"));
  std::string facts;
  const Json next_facts = part(status, "next_facts");
  for (const auto& [key, value] : next_facts.items())
    facts += fmt::format("{}{} {}", facts.empty() ? "" : ", ", key, value.get<std::string>());
  if (!facts.empty()) lines.line("next facts", base::printable(facts));
  if (const Json fleet = part(status, "fleet"); !fleet.empty()) {
    const bool connected = word(fleet, "state") == "connected";
    lines.line(
        "fleet",
        fmt::format("{} at {} as {}{}; {} results wait, {} dropped", word(fleet, "state"),
                    word(fleet, "broker"), word(fleet, "tester"), connected ? "" : ": " + word(fleet, "why"),
                    count(fleet, "outbox_count"), count(fleet, "dropped_result_count")),
        connected ? Ink::kNone : Ink::kYellow);
  }
  if (const Json page = part(status, "page"); !page.empty()) {
    // To be copied into a shell: the token itself is for those who may read its file.
    lines.line("page", fmt::format("{}#token=$(cat '{}')", word(page, "address"), word(page, "token_file")));
  }
  lines.line("version", word(status, "version"));
  return lines.list.text(wants_colours());
}

base::Result<std::string> run_status(const StatusOptions& options) {
  constexpr std::chrono::milliseconds kTimeout{5000};
  const base::Result<daemon::HttpReply> reply =
      client::request(options.socket, {"GET", "/v1/status", {}, {}, {}}, kTimeout);
  if (!reply) return tl::unexpected(reply.error());
  if (reply->status != 200)
    return base::failure("{}: refused with {}: {}", options.socket, reply->status, reply->body);
  const Json status = Json::parse(reply->body, nullptr, false);
  if (!status.is_object()) return base::failure("{}: the answer is no JSON", options.socket);
  return options.json ? io::json_document(status) : text_of(status);
}

constexpr const char* kStatusExamples =
    R"(Examples:
  stickslip status
  stickslip status --json
  stickslip status --socket /run/stickslip/control.sock)";

}  // namespace

void add_status(CLI::App& app, Chosen& chosen) {
  const auto options = std::make_shared<StatusOptions>();
  CLI::App* command = app.add_subcommand("status", "ask the running daemon");
  command->footer(kStatusExamples);
  command->add_option("--socket", options->socket, "its control socket")
      ->capture_default_str()
      ->type_name("PATH");
  command->add_flag("--json", options->json, "JSON as GET /v1/status gives it, instead of text");
  choose(*command, chosen, [options] { return run_status(*options); });
}

}  // namespace stickslip::cli
