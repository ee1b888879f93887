#include "io/verify.hpp"

#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "cli/subcommands.hpp"
#include "io/print_text.hpp"

namespace stickslip::cli {
namespace {

struct VerifyOptions {
  std::vector<std::string> files;
  bool json = false;
};

constexpr const char* kVerifyHelp =
    R"(Judges files, records and journals alike: complete or not, and why. A record carries the number of its scans, a
checksum of its raw values and one of the whole file; every byte is read, and what follows from the counts is
computed again. A flipped bit anywhere is found. docs/reliability.md says what is looked at.

Exit status:
  0  all are complete
  1  some are incomplete for a stated reason (interrupted, gaps, a journal)
  2  wrong usage
  3  some are damaged
  4  some could not be judged: no such file, no record, made by a newer program

Examples:
  stickslip verify records/*.h5
  stickslip verify records/20261121T125252Z-0003.journal
  stickslip verify records/*.h5 --json                 {"files": [{"file": …, "judgement": …, "findings": […]}]})";

}  // namespace

void add_verify(CLI::App& app, Chosen& chosen) {
  const auto options = std::make_shared<VerifyOptions>();
  CLI::App* command = app.add_subcommand("verify", "judge records and journals: whole or not, and why");
  command->footer(kVerifyHelp);
  command->add_option("files", options->files, "records and journals")->required()->type_name("FILE");
  command->add_flag("--json", options->json, "JSON instead of lines");
  command->callback([&chosen, options] {
    chosen.run = [options] {
      const io::VerifyOutput output = io::verify_files(options->files, options->json);
      io::print_text(stdout, output.text);
      return io::flushed("stickslip", output.exit_status);
    };
  });
}

}  // namespace stickslip::cli
