#include "daemon/storage/finaliser_process.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <charconv>
#include <string>
#include <string_view>
#include <system_error>

#include "core/evaluation/analyse.hpp"
#include "core/record/file.hpp"
#include "core/record/journal.hpp"
#include "core/record/reader.hpp"

namespace stickslip::storage {
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

/// Closes all descriptors in the child but stdin, stdout and stderr. Asio's sockets are not closed on exec: a
/// finaliser that outlives a killed daemon would keep the next daemon from listening.
class OnlyOutput {
 public:
  /// \param output  becomes the child's stdout.
  explicit OnlyOutput(int output) {
    posix_spawn_file_actions_init(&actions_);
    posix_spawn_file_actions_adddup2(&actions_, output, STDOUT_FILENO);
    posix_spawn_file_actions_addclosefrom_np(&actions_, STDERR_FILENO + 1);
  }
  ~OnlyOutput() { posix_spawn_file_actions_destroy(&actions_); }
  OnlyOutput(const OnlyOutput&) = delete;
  OnlyOutput& operator=(const OnlyOutput&) = delete;

  [[nodiscard]] const posix_spawn_file_actions_t* get() const noexcept { return &actions_; }

 private:
  posix_spawn_file_actions_t actions_{};
};

/// Reads until the other end is closed.
std::string read_to_end(int file) {
  constexpr std::size_t kReadAtOnce = 4096;
  std::string text;
  std::array<char, kReadAtOnce> part{};
  for (;;) {
    const ssize_t got = ::read(file, part.data(), part.size());
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return text;
    text.append(part.data(), static_cast<std::size_t>(got));
  }
}

/// What became of the journal after a failed finaliser, for the error message.
std::string_view what_is_left(const std::filesystem::path& journal) {
  std::error_code error;
  if (std::filesystem::exists(journal, error)) return "the journal is kept";
  return error ? "the journal cannot be looked at" : "the journal is not there any more";
}

}  // namespace

base::Result<record::Finalised> run_finaliser(const std::filesystem::path& program,
                                              const std::filesystem::path& journal, ExpectedScans expected) {
  std::vector<std::string> words{program.string(), "--finalise", journal.string()};
  if (expected) words.insert(words.end(), {"--scans", std::to_string(*expected)});
  std::vector<char*> arguments;
  arguments.reserve(words.size() + 1);
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  const std::string& program_text = words[0];
  const std::string& journal_text = words[2];

  std::array<int, 2> ends{};
  if (::pipe2(ends.data(), O_CLOEXEC) != 0) {
    return base::failure("{}: no pipe to the finaliser: {}", journal_text, record::system_message(errno));
  }
  const record::Descriptor from_child{ends[0]};
  record::Descriptor to_parent{ends[1]};
  const OwnProcessGroup attributes;
  const OnlyOutput descriptors{to_parent.get()};
  pid_t child = 0;
  if (const int error = posix_spawn(&child, program_text.c_str(), descriptors.get(), attributes.get(),
                                    arguments.data(), environ);
      error != 0) {
    return base::failure("{}: the finaliser {} cannot be started: {}", journal_text, program_text,
                         std::generic_category().message(error));
  }
  to_parent = record::Descriptor{};
  const std::string said = read_to_end(from_child.get());
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
  return finalised_from_text(journal, said);
}

std::string to_text(const record::Finalised& made) {
  return fmt::format("{} {} {}", made.scan_count, made.damaged_size, made.kept.string());
}

base::Result<record::Finalised> finalised_from_text(const std::filesystem::path& journal,
                                                    const std::string& text) {
  record::Finalised made;
  made.file = record_of(journal);
  const char* const end = text.data() + text.size();
  const auto scans = std::from_chars(text.data(), end, made.scan_count);
  if (scans.ec != std::errc{} || scans.ptr == end)
    return base::failure("{}: the finaliser does not say what it made", journal.string());
  const auto damaged = std::from_chars(scans.ptr + 1, end, made.damaged_size);
  if (damaged.ec != std::errc{} || damaged.ptr == end)
    return base::failure("{}: the finaliser does not say what it made", journal.string());
  made.kept = std::string{damaged.ptr + 1, end};
  return made;
}

std::string loss_of(const record::Finalised& made, ExpectedScans expected) {
  std::string loss;
  if (expected && made.scan_count < *expected) {
    loss =
        fmt::format("{} of {} scans were written and cannot be read", *expected - made.scan_count, *expected);
  }
  if (made.damaged_size > 0) {
    loss += fmt::format("{}{} bytes of its journal could not be read", loss.empty() ? "" : ", ",
                        made.damaged_size);
  }
  if (!made.kept.empty()) loss += fmt::format("; the journal is kept: {}", made.kept.string());
  return loss;
}

io::FilesFound journals_in(const std::filesystem::path& folder) {
  return io::find_files(folder, [](std::string_view name) {
    return name.size() > record::kJournalExtension.size() && name.ends_with(record::kJournalExtension);
  });
}

base::Result<record::Finalised> finalise_here(const std::filesystem::path& journal, ExpectedScans expected) {
  const auto evaluate = [](const record::Record& record) {
    base::Result<record::EndRecord> end = evaluation::analyse(record);
    if (end) return *end;
    record::EndRecord absent;
    absent.results = record::absent_results(end.error().message);
    return absent;
  };
  auto made = record::finalise(journal, evaluate, record::system_calls(), kOthersTime, expected);
  if (made || !is_finished(journal)) return made;
  const auto others = record::read_record(record_of(journal));
  if (!others) return made;
  return record::Finalised{record_of(journal), static_cast<std::int64_t>(others->scan.size()), 0, {}};
}

bool is_finished(const std::filesystem::path& journal) {
  std::error_code ignored;
  const auto type_of = [&ignored](const std::filesystem::path& file) {
    return std::filesystem::symlink_status(file, ignored).type();
  };
  return type_of(journal) == std::filesystem::file_type::not_found &&
         type_of(record_of(journal)) == std::filesystem::file_type::regular;
}

}  // namespace stickslip::storage
