#include "cli/subcommands.hpp"

#include <cstdio>
#include <utility>

#include "cli/paint.hpp"
#include "io/print_text.hpp"

namespace stickslip::cli {

int print(const base::Result<std::string>& output) {
  if (!output) {
    io::print_error("stickslip", output.error().message);
    return output.error().exit_status();
  }
  io::print_text(stdout, *output, wants_colours());
  return io::flushed("stickslip", 0);
}

void choose(CLI::App& command, Chosen& chosen, std::function<base::Result<std::string>()> run) {
  command.callback([&chosen, run = std::move(run)] { chosen.run = [run] { return print(run()); }; });
}

}  // namespace stickslip::cli
