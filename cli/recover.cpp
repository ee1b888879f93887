#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include "cli/subcommands.hpp"
#include "io/print_text.hpp"

#include "core/base/limited_child.hpp"
#include "core/base/text.hpp"
#include "daemon/storage/finaliser_process.hpp"
#include "daemon/storage/recovery.hpp"

namespace stickslip::cli {
namespace {

/// Tells on stdout what became of each journal.
class Teller final : public daemon::EventReceiver {
 public:
  void orphan_finalised(const std::filesystem::path& file) override {
    tell("made     {}\n", base::printable(file.string()));
  }
  void record_damaged(const std::filesystem::path& file, std::string_view loss) override {
    tell("damaged  {}: {}\n", base::printable(file.string()), base::printable(loss));
  }
  void orphan_empty(const std::filesystem::path& journal) override {
    tell("removed  {}: nothing was recorded in it\n", base::printable(journal.string()));
  }
  void orphan_kept(const std::filesystem::path& journal, std::string_view why) override {
    tell("kept     {}: {}\n", base::printable(journal.string()), base::printable(why));
  }
  void folder_unread(const std::filesystem::path& folder, std::string_view why) override {
    tell("unread   {}: cannot be looked into: {}\n", base::printable(folder.string()), base::printable(why));
  }

 private:
  template <typename... Args>
  static void tell(fmt::format_string<Args...> format, Args&&... args) {
    io::print_text(stdout, fmt::format(format, std::forward<Args>(args)...));
  }
};

/// Finalises in a copy of this process: HDF5's errors can end it.
class ApartFinaliser {
 public:
  ApartFinaliser() : child_(base::ChildWork{answer}) {}

  base::Result<record::Finalised> finalise(const std::filesystem::path& journal,
                                           storage::ExpectedScans expected) {
    constexpr std::chrono::hours kLongest{24};  // Only the evaluation of an interrupted test takes time.
    std::error_code ignored;
    const std::uintmax_t size = std::filesystem::file_size(journal, ignored);
    base::WorkLimits limits = base::limits_for_file(ignored ? 0 : size);
    limits.processor_time = kLongest;
    const base::Result<std::string> made =
        child_.ask(fmt::format("{} {}", expected.value_or(kUnknown), journal.native()), limits);
    if (!made) return base::failure("{}", made.error().message);
    if (!made->starts_with('+')) return base::failure("{}", made->substr(1));
    return storage::finalised_from_text(journal, made->substr(1));
  }

 private:
  static constexpr std::int64_t kUnknown = -1;

  /// In the child. \param question  the expected scans and the journal.
  static std::string answer(std::string_view question, int /*memory_file*/) {
    std::int64_t expected = kUnknown;
    const char* const end = question.data() + question.size();
    const char* const journal = std::from_chars(question.data(), end, expected).ptr + 1;
    const auto made = storage::finalise_here(
        std::filesystem::path{journal, end},
        expected == kUnknown ? storage::ExpectedScans{} : storage::ExpectedScans{expected});
    return made ? "+" + storage::to_text(*made) : "-" + made.error().message;
  }

  base::LimitedChild child_;
};

/// \return the exit status.
base::Result<int> run_recover(const std::vector<std::string>& places) {
  constexpr int kDamagedStatus = 3;
  Teller teller;
  ApartFinaliser apart;
  const storage::Finalise finalise = [&apart](const std::filesystem::path& journal,
                                              storage::ExpectedScans expected) {
    return apart.finalise(journal, expected);
  };
  storage::Recovery worst = storage::Recovery::kDone;
  for (const std::string& place : places) {
    std::error_code error;
    const std::filesystem::file_type type = std::filesystem::status(place, error).type();
    if (type == std::filesystem::file_type::not_found)
      return base::usage_error("{}: there is no such folder or journal", place);
    if (type == std::filesystem::file_type::none) {
      teller.orphan_kept(place, "cannot be looked at: " + error.message());
      worst = storage::Recovery::kRefused;
    } else if (type == std::filesystem::file_type::directory) {
      worst = std::max(worst, storage::recover_folder(place, finalise, teller));
    } else {
      worst = std::max(worst, storage::recover_journal(place, finalise, teller));
    }
  }
  switch (worst) {
    case storage::Recovery::kDone:
      return 0;
    case storage::Recovery::kDamaged:
      return kDamagedStatus;
    case storage::Recovery::kRefused:
      break;
  }
  return base::failure("not every journal became a record; each line above says why");
}

constexpr const char* kRecoverHelp =
    R"(Makes records from the journals that a stop left behind, as the daemon does when it starts: marked interrupted,
with the results that their scans allow. A journal that is being written is left alone. One in which nothing was
recorded is removed.
What is damaged in a journal is skipped, and the record holds all the rest. Such a journal is not removed but renamed
to NAME.journal.damaged; no later run takes it for one that waits for its record.

Exit status:
  0  all was done
  1  some journals became no record, or a folder cannot be looked into; each says why and stays as it is
  2  wrong usage
  3  all became records, but some were damaged and stay beside theirs

Examples:
  stickslip recover /var/lib/stickslip/records
  stickslip recover records other-records
  stickslip recover records/20261121T125252Z-0003.journal)";

}  // namespace

void add_recover(CLI::App& app, Chosen& chosen) {
  const auto places = std::make_shared<std::vector<std::string>>();
  CLI::App* command = app.add_subcommand("recover", "make records from the journals that a stop left behind");
  command->footer(kRecoverHelp);
  command->add_option("places", *places, "folders of records, or journals")
      ->required()
      ->type_name("DIR|JOURNAL");
  command->callback([&chosen, places] {
    chosen.run = [places] {
      const base::Result<int> status = run_recover(*places);
      return status ? io::flushed("stickslip", *status) : print(tl::unexpected(status.error()));
    };
  });
}

}  // namespace stickslip::cli
