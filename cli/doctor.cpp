#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <system_error>
#include <vector>

#include "cli/doctor/checks.hpp"
#include "cli/paint.hpp"
#include "cli/subcommands.hpp"
#include "io/json_text.hpp"
#include "io/print_text.hpp"
#include "io/table.hpp"
#include <nlohmann/json.hpp>

namespace stickslip::cli {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kInstalledConfig = "/etc/stickslip/stickslipd.toml";
constexpr const char* kInstalledFolder = "/var/lib/stickslip";

constexpr const char* kDoctorHelp =
    R"(Exit status: 0 all is good, 1 something is bad, 2 wrong usage, 3 there are warnings.
Nothing stays changed. Rights are those of the user who asks; those of the service:
  sudo -u stickslip stickslip doctor

Examples:
  stickslip doctor                                     the installed service
  stickslip doctor --config config/demo.toml           another configuration, here
  stickslip doctor --json)";

struct DoctorOptions {
  std::string config = kInstalledConfig;
  std::string folder;
  bool json = false;
};

Ink colour_of(doctor::Finding::Verdict verdict) {
  switch (verdict) {
    case doctor::Finding::Verdict::kGood:
      return Ink::kGreen;
    case doctor::Finding::Verdict::kUnknown:
      return Ink::kFaint;
    case doctor::Finding::Verdict::kWarning:
      return Ink::kYellow;
    case doctor::Finding::Verdict::kBad:
      break;
  }
  return Ink::kRed;
}

std::string json_of(const std::vector<doctor::Finding>& findings) {
  Json list = Json::array();
  for (const doctor::Finding& finding : findings) {
    list.push_back({{"check", finding.check},
                    {"verdict", doctor::name(finding.verdict)},
                    {"what", finding.what},
                    {"to_do", finding.to_do.empty() ? Json(nullptr) : Json(finding.to_do)}});
  }
  return io::json_document(
      Json{{"exit_status", doctor::exit_status(findings)}, {"findings", std::move(list)}});
}

std::string text_of(const std::vector<doctor::Finding>& findings, bool colours) {
  const Paint paint{colours};
  io::Table list = io::Table::list({7, 11, 0});
  for (const doctor::Finding& finding : findings) {
    list.add({paint(colour_of(finding.verdict), doctor::name(finding.verdict)), finding.check,
              base::printable(finding.what)});
    if (!finding.to_do.empty()) list.add({"", "", "→ " + base::printable(finding.to_do)});
  }
  return list.text(colours);
}

int run_doctor(const DoctorOptions& options) {
  std::error_code error;
  const std::filesystem::path config = std::filesystem::absolute(options.config, error);
  std::string folder = options.folder;
  if (folder.empty() && options.config == kInstalledConfig) folder = kInstalledFolder;
  // As the service does: relative names in the configuration are of its working directory.
  if (!folder.empty() && ::chdir(folder.c_str()) != 0 && !options.folder.empty()) {
    io::print_error("stickslip",
                    fmt::format("--folder {}: {}", folder, std::generic_category().message(errno)));
    return 2;
  }
  const auto clock = base::make_system_clock();
  const std::vector<doctor::Finding> findings =
      doctor::examine(options.folder.empty() ? options.config : config.string(), doctor::this_world(*clock));
  io::print_text(stdout, options.json ? json_of(findings) : text_of(findings, wants_colours()),
                 wants_colours());
  return io::flushed("stickslip", doctor::exit_status(findings));
}

}  // namespace

void add_doctor(CLI::App& app, Chosen& chosen) {
  const auto options = std::make_shared<DoctorOptions>();
  CLI::App* command =
      app.add_subcommand("doctor", "check everything that a test needs, and say what to do about the rest");
  command->footer(kDoctorHelp);
  command->add_option("--config", options->config, "the daemon's configuration")
      ->capture_default_str()
      ->type_name("FILE");
  command
      ->add_option(
          "--folder", options->folder,
          "where the daemon runs, for relative names in it; default: /var/lib/stickslip for the installed "
          "configuration, else here")
      ->type_name("DIR");
  command->add_flag("--json", options->json, "JSON instead of text");
  command->callback([&chosen, options] { chosen.run = [options] { return run_doctor(*options); }; });
}

}  // namespace stickslip::cli
