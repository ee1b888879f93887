#include "io/catalogue/catalogue.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>

#include <algorithm>
#include <cerrno>
#include <future>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

#include "io/catalogue/index_place.hpp"

#include "core/base/descriptor.hpp"
#include "core/base/wording.hpp"
#include "core/record/read_apart.hpp"

namespace stickslip::catalogue {
namespace {

namespace fs = std::filesystem;

/// No folder of records is deeper; bind mounts can go round in a circle.
constexpr int kDeepestFolder = 16;

/// Files between two commits: what a kill costs.
constexpr std::size_t kBatch = 200;

/// A file to be read.
struct Pending {
  std::string file;  ///< From the folder on.
  Signature signature;
};

/// What the system says of a file.
struct Look {
  Signature signature;  ///< If there is no error.
  int error = 0;        ///< As errno.

  [[nodiscard]] bool gone() const noexcept { return error == ENOENT || error == ENOTDIR; }
};

/// Looks at one file after the other, through the folder that they are in: the kernel need not walk the whole
/// path for each of thousands.
class Looker {
 public:
  Look look_at(const std::string& path) {
    const std::size_t slash = path.rfind('/');
    if (!folder_.open() || path.compare(0, slash, name_) != 0) {
      name_ = path.substr(0, slash);
      folder_ = base::Descriptor{::open(name_.c_str(), O_PATH | O_DIRECTORY | O_CLOEXEC)};
    }
    constexpr std::int64_t kNsInSecond = 1'000'000'000;
    struct stat found {};
    if (!folder_.open() || ::fstatat(folder_.get(), path.c_str() + slash + 1, &found, 0) != 0)
      return {{}, errno};
    return {{found.st_size, found.st_mtim.tv_sec * kNsInSecond + found.st_mtim.tv_nsec,
             static_cast<std::int64_t>(found.st_ino)}};
  }

 private:
  std::string name_;
  base::Descriptor folder_;
};

struct Seen {
  io::FilesFound found;
  std::vector<Look> looks;  ///< One for each file.
};

Seen look_at_records(const fs::path& folder) {
  Seen seen{.found = io::find_files(
                folder, [](std::string_view name) { return name.ends_with(".h5"); }, kDeepestFolder),
            .looks = {}};
  const std::span<const std::string> files{seen.found.files};
  seen.looks.resize(files.size());
  const auto look_at = [&](std::size_t first, std::size_t end) {
    Looker looker;
    for (std::size_t i = first; i < end; ++i) seen.looks[i] = looker.look_at(files[i]);
  };
  const std::size_t half = files.size() / 2;
  std::future<void> other = std::async(look_at, half, files.size());
  look_at(0, half);
  other.get();
  return seen;
}

/// Brings an index up to date with a folder.
class Follower {
 public:
  Follower(Index& index, const fs::path& folder, const Progress& progress)
      : index_(index), folder_(folder), progress_(progress) {}

  /// \param known  what the index held. \return whether it changed.
  bool follow(const std::vector<KnownFile>& known, const Seen& seen, Found& found) {
    const std::vector<std::string>& paths = seen.found.files;
    found.unread_folders = seen.found.unread;
    const std::size_t prefix = (folder_ / "").native().size();
    std::vector<Pending> pending;
    std::vector<UnreadFile> refused;
    std::vector<std::string> gone;
    auto next = known.begin();  // Both lists are sorted.
    for (std::size_t i = 0; i < paths.size(); ++i) {
      std::string file = paths[i].substr(prefix);
      for (; next != known.end() && next->file < file; ++next) gone.push_back(next->file);
      const KnownFile* const was = next != known.end() && next->file == file ? &*next++ : nullptr;
      const Look& look = seen.looks[i];
      if (look.gone()) {
        if (was != nullptr) gone.push_back(file);
        continue;
      }
      ++found.followed.file_count;
      if (look.error != 0) {
        refused.push_back({std::move(file), State::kNotLooked, base::system_message(look.error)});
      } else if (was == nullptr || was->state == State::kNotLooked || was->signature != look.signature) {
        pending.push_back({std::move(file), look.signature});
      }
    }
    for (; next != known.end(); ++next) gone.push_back(next->file);
    // One that another search found after the folder was listed is there.
    std::erase_if(gone, [&](const std::string& file) {
      return Looker{}.look_at((folder_ / file).native()).error == 0;
    });
    found.followed.read_count = pending.size();
    found.followed.removed_count = gone.size();
    if (!gone.empty() || !refused.empty()) {
      Transaction transaction = index_.begin();
      for (const std::string& file : gone) index_.remove(file);
      for (const UnreadFile& file : refused) index_.put_unread(file, {});
      transaction.commit();
    }
    for (std::size_t first = 0; first < pending.size(); first += kBatch)
      read(pending, first, std::min(pending.size(), first + kBatch));
    return !pending.empty() || !refused.empty() || !gone.empty();
  }

 private:
  /// Files [first, end). Reading takes long, writing does not: other processes wait only for that.
  void read(const std::vector<Pending>& pending, std::size_t first, std::size_t end) {
    std::vector<std::string> paths;
    for (std::size_t i = first; i < end; ++i) paths.push_back((folder_ / pending[i].file).string());
    std::vector<base::Result<record::Record>> records;
    for (std::size_t i = first; i < end; ++i) {
      if (progress_) progress_(i, pending.size());
      records.push_back(record::read_facts_apart(paths[i - first], std::span{paths}.subspan(i - first + 1)));
    }
    Transaction transaction = index_.begin();
    for (std::size_t i = first; i < end; ++i) put(pending[i], records[i - first]);
    transaction.commit();
  }

  void put(const Pending& file, const base::Result<record::Record>& record) {
    if (record) {
      index_.put(file.file, file.signature, *record);
    } else if (!Looker{}.look_at((folder_ / file.file).native()).gone()) {
      // A reader that died may have been killed for want of memory, by whomever.
      const bool content_is_why =
          record.error().kind == base::ErrorKind::kUsage && !record.error().worker_died;
      index_.put_unread({file.file, content_is_why ? State::kUnreadable : State::kNotLooked,
                         without_path(record.error().message, folder_ / file.file)},
                        file.signature);
    } else {
      index_.remove(file.file);  // Gone meanwhile.
    }
  }

  static std::string without_path(const std::string& message, const fs::path& path) {
    const std::string prefix = path.native() + ": ";
    return message.starts_with(prefix) ? message.substr(prefix.size()) : message;
  }

  Index& index_;
  const fs::path& folder_;
  const Progress& progress_;
};

void follow_and_find(const std::string& index_path, const fs::path& folder, const Query& query,
                     const Progress& progress, Found& found) {
  const auto look = [&folder] { return look_at_records(folder); };
  std::future<Seen> looking = std::async(look);
  Index index{index_path};
  const std::vector<KnownFile> known = index.files();
  // While the files are looked at, which takes as long: most searches find none changed.
  Matches matches = index.find(query);
  if (Follower{index, folder, progress}.follow(known, looking.get(), found)) matches = index.find(query);
  found.entries = std::move(matches.entries);
  found.match_count = matches.count;
  found.unread = index.unread();
}

std::string no_index_notice(const std::string& why) {
  return fmt::format("no index is kept, so each search reads all records: {}; set XDG_CACHE_HOME", why);
}

}  // namespace

base::Result<Found> search_with(const fs::path& index, const fs::path& folder, const Query& query,
                                const Progress& progress) {
  const std::string kept = index.string();
  std::string path = index.empty() ? ":memory:" : kept;
  std::string notice;
  for (bool was_damaged = false;;) {
    Found found;
    if (!notice.empty()) found.notices.push_back(notice);
    try {
      follow_and_find(path, folder, query, progress, found);
      return found;
    } catch (const SqlError& error) {
      if (path != kept) return base::failure("an index of the records cannot be made: {}", error.what());
      switch (error.trouble()) {
        case Trouble::kLocked:
          return tl::unexpected(base::Error{
              base::ErrorKind::kBusy,
              fmt::format("{}: {}: another search is writing it; try again", kept, error.what())});
        case Trouble::kOther:
          return base::failure("{}: {}: the index of the records cannot be used; try again", kept,
                               error.what());
        case Trouble::kDamage:
          if (!was_damaged) {
            was_damaged = true;
            notice = fmt::format("{}: was damaged; it is made anew from the records", kept);
            for (const char* const part : {"-journal", ""}) {
              std::error_code ignored;
              fs::remove(kept + part, ignored);
            }
            break;
          }
          [[fallthrough]];  // It cannot be removed, or the disk damages it.
        case Trouble::kNoPlace:
          notice = no_index_notice(fmt::format("{}: {}", kept, error.what()));
          path = ":memory:";
          break;
      }
    }
  }
}

base::Result<Found> search(const fs::path& folder, const Query& query, const Progress& progress) {
  std::error_code error;
  const fs::path whole = fs::canonical(folder, error);
  if (!error && !fs::is_directory(whole, error) && !error)
    error = std::make_error_code(std::errc::not_a_directory);
  if (!error) static_cast<void>(fs::directory_iterator{whole, error});
  if (error) {
    const bool is_wrong =
        error == std::errc::no_such_file_or_directory || error == std::errc::not_a_directory;
    return tl::unexpected(
        base::Error{is_wrong ? base::ErrorKind::kUsage : base::ErrorKind::kNoPermission,
                    fmt::format("{}: {}: name a folder of records", folder.string(), error.message())});
  }
  const base::Result<fs::path> place = index_place(whole);
  base::Result<Found> found = search_with(place.value_or(fs::path{}), whole, query, progress);
  if (found && !place) {
    found->notices.push_back(no_index_notice(place.error().message));
  }
  return found;
}

}  // namespace stickslip::catalogue
