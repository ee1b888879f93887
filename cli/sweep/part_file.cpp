#include "cli/sweep/part_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <exception>
#include <fstream>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "io/json_text.hpp"
#include <nlohmann/json.hpp>

#include "core/base/contract.hpp"
#include "core/base/regular_file.hpp"
#include "core/base/wording.hpp"
#include "core/record/json_codec.hpp"

namespace stickslip::sweep {
namespace {

using base::Result;
using Json = nlohmann::ordered_json;

constexpr const char* kFormat = "stickslip-sweep-part";
constexpr std::int64_t kFormatVersion = 1;
/// Longest time that finished runs are not synced.
constexpr std::int64_t kSyncInterval_ns = 1'000'000'000;

/// Identity of a sweep: all that decides the numbers of its runs.
Json identity_of(const record::SweepFacts& facts) {
  Json axes = Json::array();
  for (const record::SweepAxis& axis : facts.axes) {
    axes.push_back({{"key", axis.key}, {"unit", axis.unit}, {"values", axis.values}, {"words", axis.words}});
  }
  return {{"format", kFormat},        {"format_version", kFormatVersion},
          {"version", facts.version}, {"commit", facts.commit},
          {"method", facts.method},   {"scene", facts.scene_name},
          {"vary", std::move(axes)},  {"repeat", facts.repeat},
          {"seed", facts.seed},       {"scene_text", facts.scene_text}};
}

std::string line_of(const Json& json) { return io::json_text(json) + "\n"; }

/// The difference between two identities, for people; empty if they are equal.
std::string difference(const Json& there, const Json& here) {
  for (const auto& [key, value] : here.items()) {
    const auto found = there.find(key);
    if (found != there.end() && *found == value) continue;
    if (key == "scene_text") return "the scene's text, with its changes, is another";
    constexpr std::size_t kLongest = 300;
    return fmt::format("{} is {} there and {} here", key,
                       found == there.end() ? "absent" : base::one_line(found->dump(), kLongest),
                       base::one_line(value.dump(), kLongest));
  }
  return "";
}

Json parsed(const std::string& line) { return Json::parse(line, nullptr, false); }

/// Reads a line as a run; nothing if it is none.
std::optional<record::SweepRun> run_of(const std::string& line, std::int64_t run_count) {
  try {
    record::SweepRun run = record::sweep_run_from_json(line);
    if (run.number >= 0 && run.number < run_count) return run;
  } catch (const std::exception&) {
    // Not whole then.
  }
  return std::nullopt;
}

/// \param use  called with each complete line until it returns false. \return bytes of the lines that it
/// accepted.
Result<std::int64_t> for_each_line(const std::filesystem::path& path,
                                   const std::function<bool(const std::string&)>& use) {
  std::ifstream in{path, std::ios::binary};
  if (!in) return base::failure("{}: cannot be read", path.string());
  std::int64_t size = 0;
  for (std::string line; std::getline(in, line) && !in.eof();) {
    if (!use(line)) break;
    size += static_cast<std::int64_t>(line.size()) + 1;
  }
  if (in.bad()) return base::failure("{}: cannot be read", path.string());
  return size;
}

}  // namespace

PartFile::PartFile(std::filesystem::path path, record::Descriptor file, const record::SweepFacts& facts,
                   const base::Clock& clock)
    : path_(std::move(path)),
      file_(std::move(file)),
      done_(static_cast<std::size_t>(facts.run_count())),
      clock_(&clock),
      synced_ns_(clock.monotonic_ns()) {}

Result<PartFile> PartFile::open(const std::filesystem::path& path, const record::SweepFacts& facts,
                                const base::Clock& clock) {
  constexpr mode_t kMode = 0666;
  record::Descriptor file{::open(path.c_str(), O_RDWR | O_CREAT | O_NOFOLLOW | O_APPEND | O_CLOEXEC, kMode)};
  if (!file.open())
    return base::failure("{}: cannot be opened: {}", path.string(), record::system_message(errno));
  struct stat found {};
  if (::fstat(file.get(), &found) == 0 && !S_ISREG(found.st_mode))
    return base::usage_error("{}: {}", path.string(), base::why_not_regular(found.st_mode));
  if (::flock(file.get(), LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
    return base::usage_error("{}: another sweep is writing it right now: wait for it, or choose another -o",
                             path.string());
  }
  PartFile part{path, std::move(file), facts, clock};
  if (auto taken = part.take_over(facts); !taken) return tl::unexpected(taken.error());
  return part;
}

Result<void> PartFile::take_over(const record::SweepFacts& facts) {
  const Json identity = identity_of(facts);
  bool first = true;
  std::string refusal;
  const Result<std::int64_t> whole = for_each_line(path_, [&](const std::string& line) {
    if (first) {
      first = false;
      const Json there = parsed(line);
      refusal = there.is_object() && there.contains("format") && there["format"] == kFormat
                    ? difference(there, identity)
                    : "it is no part of a sweep";
      return refusal.empty();
    }
    const auto run = run_of(line, facts.run_count());
    if (!run || done_[static_cast<std::size_t>(run->number)]) return false;
    done_[static_cast<std::size_t>(run->number)] = true;
    ++done_count_;
    return true;
  });
  if (!whole) return tl::unexpected(whole.error());
  const std::string first_line = line_of(identity);
  if (*whole == 0 && refusal.empty()) {
    // Empty, or stopped while the first line was written; or a stranger.
    std::string begun;
    std::getline(std::ifstream{path_, std::ios::binary}, begun);
    if (!std::string_view{first_line}.starts_with(begun)) refusal = "it is no part of a sweep";
  }
  if (!refusal.empty()) {
    return base::usage_error(
        "{}: stands there, but {}: give the command that began it, remove it, or choose another -o",
        path_.string(), refusal);
  }
  if (::ftruncate(file_.get(), *whole) != 0) {
    return base::failure("{}: cannot be cut after its last whole line: {}", path_.string(),
                         record::system_message(errno));
  }
  if (*whole > 0) return {};
  if (auto written = write(first_line); !written) return written;
  if (auto synced = sync(); !synced) return synced;
  return record::sync_folder(record::folder_of(path_));
}

std::vector<std::int64_t> PartFile::missing() const {
  std::vector<std::int64_t> numbers;
  for (std::size_t i = 0; i < done_.size(); ++i) {
    if (!done_[i]) numbers.push_back(static_cast<std::int64_t>(i));
  }
  return numbers;
}

Result<void> PartFile::append(const record::SweepRun& run) {
  const auto number = static_cast<std::size_t>(run.number);
  STICKSLIP_EXPECTS(number < done_.size() && !done_[number]);
  if (auto written = write(record::sweep_run_to_json(run) + "\n"); !written) return written;
  done_[number] = true;
  ++done_count_;
  return clock_->monotonic_ns() - synced_ns_ < kSyncInterval_ns ? Result<void>{} : sync();
}

Result<void> PartFile::write(const std::string& line) {
  for (std::string_view rest = line; !rest.empty();) {
    const ssize_t written = ::write(file_.get(), rest.data(), rest.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) {
      return base::failure("{}: cannot be written: {}; the runs in it are kept, the same command goes on",
                           path_.string(), record::system_message(errno));
    }
    rest.remove_prefix(static_cast<std::size_t>(written));
  }
  return {};
}

Result<void> PartFile::sync() {
  synced_ns_ = clock_->monotonic_ns();
  if (::fdatasync(file_.get()) == 0) return {};
  return base::failure("{}: cannot be made durable: {}", path_.string(), record::system_message(errno));
}

Result<record::SweepTable> PartFile::table() const {
  record::SweepTable table{static_cast<std::int64_t>(done_.size())};
  bool first = true;
  std::int64_t count = 0;
  const Result<std::int64_t> whole = for_each_line(path_, [&](const std::string& line) {
    const auto run = first ? std::nullopt : run_of(line, static_cast<std::int64_t>(done_.size()));
    if (run) {
      table.set(*run);
      ++count;
    }
    return std::exchange(first, false) || run.has_value();
  });
  if (!whole) return tl::unexpected(whole.error());
  if (count != done_count_) {
    return base::failure(
        "{}: somebody changed it: {} of {} runs are left; the same command does the others again",
        path_.string(), count, done_count_);
  }
  return table;
}

Result<void> PartFile::remove() {
  if (::unlink(path_.c_str()) != 0) {
    return base::failure("{}: cannot be removed: {}", path_.string(), record::system_message(errno));
  }
  return record::sync_folder(record::folder_of(path_));
}

}  // namespace stickslip::sweep
