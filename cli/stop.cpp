#include "cli/bench_command.hpp"

namespace stickslip::cli {

void add_stop(CLI::App& app, Chosen& chosen) {
  add_test_command(app, chosen, "stop", "end the running test; an armed bench is idle then");
}

}  // namespace stickslip::cli
