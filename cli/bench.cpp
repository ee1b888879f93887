// Commands to the running daemon, and what it says of its tests.

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <utility>

#include "cli/ask.hpp"
#include "cli/commands.hpp"
#include "cli/json_words.hpp"
#include "io/print_text.hpp"
#include <nlohmann/json.hpp>

#include "core/base/text.hpp"
#include "daemon/client/live_client.hpp"

namespace stickslip::cli {
namespace {

using Json = nlohmann::ordered_json;

std::string line_of_test(const Json& test) {
  const Json& results = test["results"];
  return fmt::format("{:>5}  {:<15}  {:>7}  {:>7}  {:>7}  {:>6}  {:<18}  {}\n",
                     test["number"].get<std::int64_t>(), word(results, "regime"), number(results, "mu_s", 4),
                     number(results, "mu_k", 4), number(results, "delta_mu", 4),
                     number(results, "cycle_count", 0), word(test, "cause"), word(test, "file"));
}

/// One line for people; empty for frames that are for pictures.
std::string line_of_frame(const Json& frame) {
  const std::string type = word(frame, "type");
  if (type == "bench") {
    return fmt::format("bench: {}{}\n", word(frame, "bench"),
                       frame.contains("trouble") ? "; " + word(frame, "trouble") : "");
  }
  if (type == "test-began")
    return fmt::format("test {} began at scan {}\n", frame["test"].dump(), frame["trigger_scan"].dump());
  if (type == "cycle") {
    return fmt::format("  cycle {:>4}  at {:>8} s  peak {}  S - K {}  {}\n",
                       frame["number"].get<std::int64_t>(), number(frame, "peak_time", 3),
                       number(frame, "peak", 4), number(frame, "delta_mu", 4),
                       frame["captured"] == true ? "sticks again" : "slides on");
  }
  if (type == "gap")
    return fmt::format("gap: {} scans missing: {}\n", frame["scan_count"].dump(), word(frame, "cause"));
  if (type == "note") return fmt::format("{}\n", word(frame, "text"));
  if (type == "test-ended") {
    const Json& results = frame["results"];
    return fmt::format("test {} ended: {}; {}, S {}, K {}, S - K {}\n", frame["test"].dump(),
                       word(frame, "cause"), word(results, "regime"), number(results, "mu_s", 4),
                       number(results, "mu_k", 4), number(results, "delta_mu", 4));
  }
  if (type == "dropped")
    return fmt::format("({} frames left out: this is too slow)\n", frame["frame_count"].dump());
  return {};
}

}  // namespace

base::Result<std::string> run_bench_command(const BenchOptions& options, const BenchCommand& command) {
  Json body = Json::object();
  if (!command.text.empty()) body["text"] = command.text;
  if (command.test) body["test"] = *command.test;
  const base::Result<std::string> said = body_of(body);
  if (!said) return tl::unexpected(said.error());
  const base::Result<Json> done =
      ask(options, {"POST", "/v1/" + command.verb, body.empty() ? "" : *said, {}, command.key});
  if (!done) return tl::unexpected(done.error());
  if (options.json) return done->dump(2) + "\n";
  std::string line =
      fmt::format("{}: {}; test {}, scan {}{}\n", command.verb, word(*done, "bench"), (*done)["test"].dump(),
                  (*done)["scan"].dump(), (*done)["already"] == true ? " (had been done)" : "");
  if (command.verb == "tare") {
    line += fmt::format("zero {} V ± {} V, from {} scans; the force is {} N less than before\n",
                        number(*done, "zero", 6), number(*done, "zero_standard_error", 6),
                        (*done)["scan_count"].dump(), number(*done, "moved_force", 4));
  }
  return line;
}

base::Result<std::string> run_plan(const BenchOptions& options, const PlanCommand& command) {
  base::Result<Json> plan = ask(options, {"GET", "/v1/plan", {}, {}, {}});
  if (!plan) return tl::unexpected(plan.error());
  if (command.clear) plan = Json::object();
  for (const auto& [key, value] : command.changes) {
    if (key == "replicate" || key == "pull_speed") {
      const Json parsed = Json::parse(value, nullptr, false);
      (*plan)[key] = parsed.is_discarded() ? Json(value) : parsed;
    } else {
      (*plan)[key] = value.empty() ? Json(nullptr) : Json(value);
    }
  }
  if (command.clear || !command.changes.empty()) {
    const base::Result<std::string> said = body_of(*plan);
    if (!said) return tl::unexpected(said.error());
    plan = ask(options, {"PUT", "/v1/plan", *said, {}, {}});
    if (!plan) return tl::unexpected(plan.error());
  }
  if (options.json) return plan->dump(2) + "\n";
  std::string text;
  for (const auto& [key, value] : plan->items()) {
    std::string shown = value.is_string() ? value.get<std::string>() : value.dump();
    if (value.is_null()) shown = "–";
    if (key == "pull_speed" && value.is_number()) shown = fmt::format("{:.6g} m/s", value.get<double>());
    text += fmt::format("{:<10}  {}\n", key, base::printable(shown));
  }
  return text;
}

base::Result<std::string> run_list(const BenchOptions& options) {
  const base::Result<Json> list = ask(options, {"GET", "/v1/tests", {}, {}, {}});
  if (!list) return tl::unexpected(list.error());
  if (options.json) return list->dump(2) + "\n";
  std::string text = fmt::format("{:>5}  {:<15}  {:>7}  {:>7}  {:>7}  {:>6}  {:<18}  {}\n", "test", "regime",
                                 "S", "K", "S - K", "cycles", "ended", "file");
  for (const Json& test : (*list)["tests"]) text += line_of_test(test);
  return text;
}

base::Result<std::string> run_show(const BenchOptions& options, std::int64_t number_of_test) {
  const base::Result<Json> test =
      ask(options, {"GET", fmt::format("/v1/tests/{}", number_of_test), {}, {}, {}});
  if (!test) return tl::unexpected(test.error());
  if (options.json) return test->dump(2) + "\n";
  std::string text =
      fmt::format("test {}: {}, ended: {}\nfile: {}\n", (*test)["number"].dump(),
                  word((*test)["results"], "regime"), word(*test, "cause"), word(*test, "file"));
  for (const auto& [name, detail] : (*test)["results"]["details"].items()) {
    if (!detail.contains("value")) continue;
    const Json& value = detail["value"];
    const std::string error = detail.contains("standard_error")
                                  ? fmt::format(" ± {:.2g}", detail["standard_error"].get<double>())
                                  : "";
    const std::string unit = word(detail, "unit");
    text += value.is_null() ? fmt::format("  {:<26} – {}\n", name, word(detail, "reason"))
                            : fmt::format("  {:<26} {:.6g}{}{}\n", name, value.get<double>(), error,
                                          unit == "1" ? "" : " " + unit);
  }
  return text;
}

base::Result<std::string> run_watch(const BenchOptions& options, std::int64_t tests) {
  std::int64_t left = tests;
  const base::Result<void> ended = client::listen_live(options.socket, [&](std::string_view text) {
    if (options.json) {
      io::print_text(stdout, fmt::format("{}\n", text));
    }
    const Json frame = Json::parse(text, nullptr, false);
    if (!frame.is_object()) return true;
    if (!options.json) io::print_text(stdout, line_of_frame(frame));
    if (word(frame, "type") == "test-ended" && --left == 0) return false;
    return std::fflush(stdout) == 0;
  });
  if (!ended) return tl::unexpected(ended.error());
  return std::string{};
}

}  // namespace stickslip::cli
