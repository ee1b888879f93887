#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <memory>
#include <string>
#include <system_error>

#include "cli/subcommands.hpp"
#include "io/library.hpp"

#include "core/base/wording.hpp"

namespace stickslip::cli {
namespace {

constexpr const char* kDemoHelp =
    R"(Measures ten simulated tests of two papers, fifty times as fast as a real tester, and prints each result beside
what was simulated. No board, no configuration and no privilege is needed. The records stay below the folder.

Examples:
  stickslip demo
  stickslip demo --folder /tmp/demo
  stickslip demo --folder /tmp/demo && stickslip report /tmp/demo/records/demo/*.h5 -o report.html)";

/// Becomes the daemon. \return only where that failed.
base::Result<std::string> run_demo(const std::string& folder) {
  const auto scenes = io::library_folder(io::kScenes, "");
  if (!scenes) return tl::unexpected(scenes.error());
  const std::filesystem::path config = scenes->parent_path() / "demo.toml";
  std::error_code error;
  const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe", error);
  const std::filesystem::path daemon = program.parent_path() / "stickslipd";
  for (const auto& needed : {config, daemon}) {
    if (!std::filesystem::exists(needed, error))
      return base::usage_error("{}: is not there, and belongs to stickslip; install it anew",
                               needed.string());
  }
  std::filesystem::create_directories(folder, error);
  if (!error) std::filesystem::current_path(folder, error);
  if (error)
    return base::usage_error("{}: {}; name another with --folder", base::one_line(folder, 200),
                             error.message());
  execl(daemon.c_str(), daemon.c_str(), "--config", config.c_str(), nullptr);
  return base::usage_error("{}: {}", daemon.string(), std::generic_category().message(errno));
}

}  // namespace

void add_demo(CLI::App& app, Chosen& chosen) {
  const auto folder = std::make_shared<std::string>("stickslip-demo");
  CLI::App* demo = app.add_subcommand("demo", "measure ten simulated tests and print them beside the truth");
  demo->footer(kDemoHelp);
  demo->add_option("--folder", *folder, "where its records go, made if absent; default stickslip-demo")
      ->type_name("DIR");
  choose(*demo, chosen, [folder] { return run_demo(*folder); });
}

}  // namespace stickslip::cli
