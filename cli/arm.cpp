#include <memory>

#include "cli/bench_command.hpp"

namespace stickslip::cli {

namespace {

constexpr const char* kArmExamples =
    R"(Examples:
  stickslip arm
  stickslip arm --as ann                                       others are refused for half a minute
  stickslip arm --json)";

}  // namespace

void add_arm(CLI::App& app, Chosen& chosen) {
  const auto options = std::make_shared<BenchCommand>();
  options->verb = "arm";
  CLI::App* command = add_bench_command(app, *options, "the force may begin the next test");
  command->footer(kArmExamples);
  choose(*command, chosen, [options] { return run_bench_command(*options, {}); });
}

}  // namespace stickslip::cli
