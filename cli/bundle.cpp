#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <ctime>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "cli/bundle_parts.hpp"
#include "cli/doctor/checks.hpp"
#include "cli/doctor_findings.hpp"
#include "cli/installation.hpp"
#include "cli/redaction.hpp"
#include "cli/subcommands.hpp"
#include "io/json_text.hpp"
#include "io/new_file.hpp"
#include <nlohmann/json.hpp>

#include "core/base/text.hpp"
#include "core/base/version.hpp"
#include "core/record/finaliser.hpp"
#include "core/record/iso_time.hpp"

namespace stickslip::cli {
namespace {

constexpr int kMostRecords = 100;
/// Only the user who made it reads it: it holds lines of the journal, which not everybody may read.
constexpr mode_t kOwnerReads = 0600;

struct BundleOptions {
  Installation installation;
  std::string output;  ///< Empty: named by the time, in the working directory.
  std::string log;     ///< File of the daemon's log; empty: the journal.
  int record_count = 5;
  bool with_names = false;
};

class Bundle {
 public:
  explicit Bundle(const BundleOptions& options) : options_(options), redaction_(options.with_names) {}

  /// \param file  the configuration. \param now_ns  nanoseconds since 1970, UTC.
  std::string text(const std::filesystem::path& file, base::Clock& clock) && {
    const bundle::Named named = bundle::named_in(file);
    std::vector<doctor::Finding> findings;
    const std::string unexamined = part([&] {
      findings = doctor::examine(file, doctor::this_world(clock));
      return std::string{};
    });
    text_ = fmt::format("stickslip {} ({}): bundle of {}\n{}\n", base::kVersion, base::kCommit,
                        record::iso_time(clock.realtime_ns()), about(options_.with_names));
    add("What is wrong", [&] { return unexamined.empty() ? wrong(findings) : unexamined; });
    add("System", [&] { return bundle::system_text(named); });
    add("Checks of stickslip doctor",
        [&] { return io::json_document(redaction_.json(findings_json(findings))); });
    add(
        "Configuration " + file.string(), [&] { return bundle::configuration_text(file, redaction_); }, true);
    add(
        "Files that it names", [&] { return bundle::named_files_text(named, redaction_); }, true);
    add("Status of the daemon", [&] { return bundle::status_text(named, redaction_); });
    add("Log", [&] { return bundle::log_text(options_.log); });
    add("Record folder " + named.record_folder.string(), [&] { return bundle::folder_text(named); });
    add(fmt::format("Last records, {} at most, without scans", options_.record_count),
        [&] { return bundle::records_text(named, options_.record_count, redaction_); });
    return base::printable_lines(text_);
  }

 private:
  static std::string about(bool with_names) {
    return fmt::format(
        "Read it before you send it. Of settings it shows numbers, switches and a few words; [removed] "
        "stands\n"
        "for the rest. The log may hold more. {}\n",
        with_names ? "Names of operators and samples stay, as --with-names was given."
                   : "[name left out] stands for what people typed, such as\noperators and samples; "
                     "--with-names keeps it.");
  }

  static std::string wrong(std::vector<doctor::Finding> findings) {
    std::erase_if(findings, [](const doctor::Finding& finding) {
      return finding.verdict == doctor::Finding::Verdict::kGood ||
             finding.verdict == doctor::Finding::Verdict::kUnknown;
    });
    std::ranges::stable_sort(findings, std::ranges::greater{}, &doctor::Finding::verdict);  // Bad first.
    return findings.empty() ? "stickslip doctor found nothing wrong\n" : findings_text(findings, false);
  }

  /// A part that throws says why; the others stay.
  static std::string part(const std::function<std::string()>& text) {
    try {
      return text();
    } catch (const std::exception& error) {
      return fmt::format("missing: {}\n", error.what());
    }
  }

  /// \param is_filtered  the part leaves out by itself what it must.
  void add(const std::string& heading, const std::function<std::string()>& text, bool is_filtered = false) {
    const std::string body = part(text);
    text_ += fmt::format("\n== {}{}", redaction_.lines(base::printable(heading)),
                         is_filtered ? body : redaction_.lines(body));
  }

  const BundleOptions& options_;
  Redaction redaction_;
  std::string text_;
};

base::Result<std::string> run_bundle(const BundleOptions& options) {
  const auto clock = base::make_system_clock();
  constexpr std::int64_t kNsPerSecond = 1'000'000'000;
  std::string name = options.output;
  if (name.empty())
    name = fmt::format("stickslip-bundle-{:%Y%m%dT%H%M%SZ}.txt",
                       fmt::gmtime(static_cast<std::time_t>(clock->realtime_ns() / kNsPerSecond)));
  BundleOptions entered = options;
  std::error_code error;
  // Before the working directory changes.
  const std::filesystem::path output = std::filesystem::absolute(name, error);
  if (!options.log.empty()) entered.log = std::filesystem::absolute(options.log, error).string();
  if (auto free = record::check_publishable(output); !free) return tl::unexpected(free.error());
  const base::Result<std::string> config = enter(options.installation);
  if (!config) return tl::unexpected(config.error());
  const std::string text = Bundle{entered}.text(*config, *clock);
  if (auto written = io::write_new_file(output, text, kOwnerReads); !written)
    return tl::unexpected(written.error());
  return fmt::format("{}: {} kB; read it, then send it\n", base::printable(name), (text.size() + 999) / 1000);
}

constexpr const char* kBundleHelp =
    R"(Writes one text file for support: what is wrong, system, the checks of stickslip doctor, configuration, method,
characterisation and calibration, status and log of the daemon, the record folder, and facts and results of the last
records, without scans. A part that cannot be had says why; the daemon need not run. Nothing is sent.

Of settings it shows numbers, switches and a few words, such as the driver. Left out: comments; and, without
--with-names, names of operators and samples and other texts that people typed. The log may hold more: read the file
before you send it. It holds what you may read; members of the groups stickslip and adm may read everything.

Exit status: 0 written, whatever is wrong in it; 1 not written; 2 wrong usage, or FILE exists, or its folder does not.

Examples:
  stickslip bundle                                     the installed service: stickslip-bundle-TIME.txt
  stickslip bundle --config bench.toml --log bench.log -o bundle.txt
  stickslip bundle --records 20 --with-names)";

}  // namespace

void add_bundle(CLI::App& app, Chosen& chosen) {
  const auto options = std::make_shared<BundleOptions>();
  CLI::App* command =
      app.add_subcommand("bundle", "all that support needs to know, in one file to read and send");
  command->footer(kBundleHelp);
  add_installation_options(*command, options->installation);
  command
      ->add_option("-o,--output", options->output, "written here; default: stickslip-bundle-TIME.txt, here")
      ->type_name("FILE");
  command->add_option("--log", options->log, "the daemon's log, if it goes to a file; default: the journal")
      ->type_name("FILE");
  command->add_option("--records", options->record_count, "so many of the last records")
      ->capture_default_str()
      ->type_name("N")
      ->check(CLI::Range(0, kMostRecords));
  command->add_flag("--with-names", options->with_names,
                    "keep names of operators and samples, and other texts that people typed");
  choose(*command, chosen, [options] { return run_bundle(*options); });
}

}  // namespace stickslip::cli
