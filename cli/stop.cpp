#include "cli/bench_command.hpp"

namespace stickslip::cli {

namespace {

constexpr const char* kStopExamples =
    R"(Examples:
  stickslip stop
  stickslip stop --test 7
  stickslip stop --json)";

}  // namespace

void add_stop(CLI::App& app, Chosen& chosen) {
  add_test_command(app, chosen, "stop", "end the running test; an armed bench is idle then", kStopExamples);
}

}  // namespace stickslip::cli
