#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "cli/doctor/checks.hpp"
#include "cli/doctor_findings.hpp"
#include "cli/installation.hpp"
#include "cli/paint.hpp"
#include "cli/subcommands.hpp"
#include "io/json_text.hpp"
#include "io/print_text.hpp"

namespace stickslip::cli {
namespace {

constexpr const char* kDoctorHelp =
    R"(Exit status: 0 all is good, 1 something is bad, 2 wrong usage, 3 there are warnings.
Nothing stays changed. Rights are those of the user who asks; those of the service:
  sudo -u stickslip stickslip doctor

Examples:
  stickslip doctor                                     the installed service
  stickslip doctor --config config/demo.toml           another configuration, here
  stickslip doctor --json)";

struct DoctorOptions {
  Installation installation;
  bool json = false;
};

int run_doctor(const DoctorOptions& options) {
  const base::Result<std::string> config = enter(options.installation);
  if (!config) return print(tl::unexpected(config.error()));
  const auto clock = base::make_system_clock();
  const std::vector<doctor::Finding> findings = doctor::examine(*config, doctor::this_world(*clock));
  io::print_text(
      stdout,
      options.json ? io::json_document(findings_json(findings)) : findings_text(findings, wants_colours()),
      wants_colours());
  return io::flushed("stickslip", doctor::exit_status(findings));
}

}  // namespace

void add_doctor(CLI::App& app, Chosen& chosen) {
  const auto options = std::make_shared<DoctorOptions>();
  CLI::App* command =
      app.add_subcommand("doctor", "check everything that a test needs, and say what to do about the rest");
  command->footer(kDoctorHelp);
  add_installation_options(*command, options->installation);
  command->add_flag("--json", options->json, "JSON instead of text");
  command->callback([&chosen, options] { chosen.run = [options] { return run_doctor(*options); }; });
}

}  // namespace stickslip::cli
