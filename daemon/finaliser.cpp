#include "daemon/finaliser.hpp"

#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <string>
#include <string_view>
#include <system_error>

#include "core/record/finaliser.hpp"
#include "core/record/journal.hpp"
#include "daemon/analyse.hpp"
#include "daemon/dated_folders.hpp"

namespace stickslip::daemon {
namespace {

/// posix_spawn attributes that put the child into its own process group.
class OwnProcessGroup {
 public:
  OwnProcessGroup() {
    posix_spawnattr_init(&attributes_);
    posix_spawnattr_setpgroup(&attributes_, 0);
    posix_spawnattr_setflags(&attributes_, POSIX_SPAWN_SETPGROUP);
  }
  ~OwnProcessGroup() { posix_spawnattr_destroy(&attributes_); }
  OwnProcessGroup(const OwnProcessGroup&) = delete;
  OwnProcessGroup& operator=(const OwnProcessGroup&) = delete;

  [[nodiscard]] const posix_spawnattr_t* get() const noexcept { return &attributes_; }

 private:
  posix_spawnattr_t attributes_{};
};

/// Nothing of the daemon's stays open in the child: Asio's sockets are not closed on exec, and a finaliser
/// that outlives a killed daemon would keep the next one from listening.
class NoDescriptors {
 public:
  NoDescriptors() {
    posix_spawn_file_actions_init(&actions_);
    posix_spawn_file_actions_addclosefrom_np(&actions_, STDERR_FILENO + 1);
  }
  ~NoDescriptors() { posix_spawn_file_actions_destroy(&actions_); }
  NoDescriptors(const NoDescriptors&) = delete;
  NoDescriptors& operator=(const NoDescriptors&) = delete;

  [[nodiscard]] const posix_spawn_file_actions_t* get() const noexcept { return &actions_; }

 private:
  posix_spawn_file_actions_t actions_{};
};

/// Of the journal, after a finaliser that failed.
std::string_view what_is_left(const std::filesystem::path& journal) {
  std::error_code error;
  if (std::filesystem::exists(journal, error)) return "the journal is kept";
  return error ? "the journal cannot be looked at" : "the journal is not there any more";
}

}  // namespace

std::filesystem::path record_of(const std::filesystem::path& journal) {
  std::filesystem::path file = journal;
  file.replace_extension(record::kRecordExtension);
  return file;
}

base::Result<std::filesystem::path> run_finaliser(const std::filesystem::path& program,
                                                  const std::filesystem::path& journal) {
  std::string program_text = program.string();
  std::string option = "--finalise";
  std::string journal_text = journal.string();
  const std::array<char*, 4> arguments{program_text.data(), option.data(), journal_text.data(), nullptr};

  const OwnProcessGroup attributes;
  const NoDescriptors descriptors;
  pid_t child = 0;
  if (const int error = posix_spawn(&child, program_text.c_str(), descriptors.get(), attributes.get(),
                                    arguments.data(), environ);
      error != 0) {
    return base::failure("{}: the finaliser {} cannot be started: {}", journal_text, program_text,
                         std::generic_category().message(error));
  }
  int status = 0;
  while (waitpid(child, &status, 0) == -1) {
    if (errno != EINTR) {
      return base::failure("{}: the finaliser cannot be waited for: {}", journal_text,
                           std::generic_category().message(errno));
    }
  }
  if (WIFSIGNALED(status)) {
    return base::failure("{}: the finaliser was ended by signal {}; {}", journal_text, WTERMSIG(status),
                         what_is_left(journal));
  }
  if (WEXITSTATUS(status) != 0) {
    return base::failure("{}: the finaliser ended with status {}; {}", journal_text, WEXITSTATUS(status),
                         what_is_left(journal));
  }
  return record_of(journal);
}

std::vector<std::filesystem::path> journals_in(const std::filesystem::path& folder) {
  using Walk = std::filesystem::recursive_directory_iterator;
  std::vector<std::filesystem::path> journals;
  std::error_code error;
  for (Walk entry{folder, error}; !error && entry != Walk{}; entry.increment(error)) {
    if (entry.depth() >= kDeepestRecordFolder) entry.disable_recursion_pending();
    if (entry->path().extension() == record::kJournalExtension) journals.push_back(entry->path());
  }
  std::sort(journals.begin(), journals.end());
  return journals;
}

base::Result<std::filesystem::path> finalise_here(const std::filesystem::path& journal) {
  const auto evaluate = [](const record::Record& record) {
    base::Result<record::EndRecord> end = analyse(record);
    if (end) return *end;
    record::EndRecord absent;
    absent.results = record::absent_results(end.error().message);
    return absent;
  };
  auto file = record::finalise(journal, evaluate, record::system_calls(), kOthersTime);
  if (!file && is_finished(journal)) return record_of(journal);
  return file;
}

bool is_finished(const std::filesystem::path& journal) {
  std::error_code ignored;
  return !std::filesystem::exists(journal, ignored) && std::filesystem::exists(record_of(journal), ignored);
}

}  // namespace stickslip::daemon
