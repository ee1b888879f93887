#include <fmt/format.h>

#include <cstdint>
#include <cstdio>
#include <memory>
#include <string>
#include <string_view>

#include "cli/ask.hpp"
#include "cli/json_members.hpp"
#include "cli/subcommands.hpp"
#include "io/findings_text.hpp"
#include "io/print_text.hpp"
#include <nlohmann/json.hpp>

#include "core/record/finding_json.hpp"
#include "daemon/client/live_client.hpp"

namespace stickslip::cli {
namespace {

using Json = nlohmann::ordered_json;

struct WatchOptions : BenchOptions {
  std::int64_t tests = 0;  ///< To wait for the end of; 0: for ever.
};

/// One line for people, and two for each finding; empty for frames that are for pictures.
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
    std::string text =
        fmt::format("test {} ended: {}; {}, S - K {}, S {}, K {}\n", frame["test"].dump(),
                    word(frame, "cause"), word(results, "regime"), coefficient(results, "delta_mu"),
                    coefficient(results, "mu_s"), coefficient(results, "mu_k"));
    for (const base::Finding& finding : record::findings_in(results)) text += io::finding_text(finding);
    return text;
  }
  if (type == "dropped")
    return fmt::format("({} frames left out: this is too slow)\n", frame["frame_count"].dump());
  return {};
}

/// Prints as it comes.
base::Result<std::string> run_watch(const WatchOptions& options) {
  std::int64_t left = options.tests;
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

constexpr const char* kWatchExamples =
    R"(Examples:
  stickslip watch
  stickslip watch --tests 5                                    leaves after five tests
  stickslip watch --json)";

}  // namespace

void add_watch(CLI::App& app, Chosen& chosen) {
  const auto options = std::make_shared<WatchOptions>();
  CLI::App* command =
      app.add_subcommand("watch", "print tests, cycles and gaps as they happen, until Ctrl-C");
  command->footer(kWatchExamples);
  add_bench_options(*command, *options, false);
  command->add_option("--tests", options->tests, "leave when so many tests have ended")->type_name("N");
  choose(*command, chosen, [options] { return run_watch(*options); });
}

}  // namespace stickslip::cli
