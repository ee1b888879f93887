#include "cli/bench_command.hpp"

namespace stickslip::cli {

namespace {

constexpr const char* kStartExamples =
    R"(Examples:
  stickslip start
  stickslip start --test 7                                     asked again, it is not begun twice
  stickslip start --as ann)";

}  // namespace

void add_start(CLI::App& app, Chosen& chosen) {
  add_test_command(app, chosen, "start", "begin a test with the next scan, whatever the force",
                   kStartExamples);
}

}  // namespace stickslip::cli
