#include "cli/bench_command.hpp"

namespace stickslip::cli {

void add_start(CLI::App& app, Chosen& chosen) {
  add_test_command(app, chosen, "start", "begin a test with the next scan, whatever the force");
}

}  // namespace stickslip::cli
