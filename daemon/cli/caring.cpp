// Subcommands that take care of records: verify, recover.

#include <fmt/format.h>

#include <cstdio>
#include <filesystem>
#include <vector>

#include "daemon/cli/subcommands.hpp"
#include "daemon/finaliser.hpp"
#include "daemon/forked.hpp"
#include "daemon/recovery.hpp"
#include "daemon/verify.hpp"

namespace stickslip::daemon {
namespace {

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
  stickslip verify records/*.h5 --json                 {"files": [{"file": …, "judgement": …, "findings": […]}]})";

constexpr const char* kRecoverHelp =
    R"(Makes records from the journals that a stop left behind, as the daemon does when it starts: marked interrupted,
with the results that their scans allow. A journal that is being written is left alone. One in which nothing was
recorded is removed. Exit status 0 if all was done, 1 if something was not, 2 for wrong usage.

Examples:
  stickslip recover /var/lib/stickslip/records
  stickslip recover records/20261121T125252Z-0003.journal)";

struct VerifyOptions {
  std::vector<std::string> files;
  bool json = false;
};

void add_verify(CLI::App& app, Chosen& chosen) {
  const auto kept = std::make_shared<VerifyOptions>();
  CLI::App* verify = app.add_subcommand("verify", "whole or not, and why: any record or journal");
  verify->footer(kVerifyHelp);
  verify->add_option("files", kept->files, "records and journals")->required()->type_name("FILE");
  verify->add_flag("--json", kept->json, "JSON instead of lines");
  verify->callback([&chosen, kept] {
    chosen.run = [kept] {
      const VerifyOutput output = verify_files(kept->files, kept->json);
      fmt::print("{}", output.text);
      return std::fflush(stdout) == 0 ? output.exit_status : 1;
    };
  });
}

/// Tells on stdout what became of each journal.
class Teller final : public Facts {
 public:
  void orphan_finalised(const std::filesystem::path& file) override {
    fmt::print("made     {}\n", file.string());
  }
  void orphan_empty(const std::filesystem::path& journal) override {
    fmt::print("removed  {}: nothing was recorded in it\n", journal.string());
  }
  void orphan_kept(const std::filesystem::path& journal, std::string_view why) override {
    fmt::print("kept     {}: {}\n", journal.string(), why);
  }
};

/// In a copy of this process: HDF5's errors can end it.
base::Result<std::filesystem::path> finalise_apart(const std::filesystem::path& journal) {
  constexpr std::chrono::hours kLongest{24};  // Only the evaluation of an interrupted test takes time.
  const auto work = [&journal]() -> std::string {
    const auto file = finalise_here(journal);
    return file ? std::string{} : file.error().message;
  };
  const base::Result<ForkedAnswer> answer = run_forked(work, kLongest);
  if (!answer) return tl::unexpected(answer.error());
  if (answer->signal) return base::failure("finishing it ended by signal {}", *answer->signal);
  if (!answer->text.empty()) return base::failure("{}", answer->text);
  return record_of(journal);
}

base::Result<std::string> recover(const std::vector<std::string>& places) {
  Teller teller;
  bool all = true;
  for (const std::string& place : places) {
    std::error_code ignored;
    if (std::filesystem::is_directory(place, ignored)) {
      all = recover_folder(place, finalise_apart, teller) && all;
    } else if (std::filesystem::exists(place, ignored)) {
      all = recover_journal(place, finalise_apart, teller) && all;
    } else {
      return base::usage_error("{}: there is no such folder or journal", place);
    }
  }
  if (!all) return base::failure("not every journal became a record");
  return std::string{};
}

void add_recover(CLI::App& app, Chosen& chosen) {
  const auto places = std::make_shared<std::vector<std::string>>();
  CLI::App* command = app.add_subcommand("recover", "records from the journals that a stop left behind");
  command->footer(kRecoverHelp);
  command->add_option("places", *places, "folders of records, or journals")
      ->required()
      ->type_name("DIR|JOURNAL");
  choose(*command, chosen, [places] { return recover(*places); });
}

}  // namespace

void add_caring_commands(CLI::App& app, Chosen& chosen) {
  add_verify(app, chosen);
  add_recover(app, chosen);
}

}  // namespace stickslip::daemon
