#include <fmt/format.h>

#include <memory>
#include <string>

#include "cli/bench_command.hpp"
#include "cli/json_members.hpp"

namespace stickslip::cli {
namespace {

std::string zero_line(const nlohmann::ordered_json& done) {
  return fmt::format("zero {} V ± {} V, from {} scans; the force is {} N less than before\n",
                     number(done, "zero", 6), number(done, "zero_standard_error", 6),
                     done["scan_count"].dump(), number(done, "moved_force", 4));
}

constexpr const char* kTareExamples =
    R"(Examples:
  stickslip tare                                               first take the sled off: nothing may pull
  stickslip tare --as ann
  stickslip tare --json)";

}  // namespace

void add_tare(CLI::App& app, Chosen& chosen) {
  const auto options = std::make_shared<BenchCommand>();
  options->verb = "tare";
  CLI::App* command = add_bench_command(app, *options, "make what the unloaded load cell shows now its zero");
  command->footer(kTareExamples);
  choose(*command, chosen, [options] { return run_bench_command(*options, {}, zero_line); });
}

}  // namespace stickslip::cli
