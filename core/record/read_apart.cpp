#include "core/record/read_apart.hpp"

#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "core/base/regular_file.hpp"
#include "core/record/entry_builder.hpp"
#include "core/record/file.hpp"
#include "core/record/journal.hpp"
#include "core/record/reader.hpp"

namespace stickslip::record {
namespace {

/// Of one entry of the journal in memory.
constexpr std::size_t kMostScans = std::size_t{1} << 16U;

// The first letter of an answer.
constexpr char kRead = '+';   ///< The checksum follows.
constexpr char kUsage = 'u';  ///< Kinds of errors; the message follows.
constexpr char kFailure = 'f';
constexpr char kBusy = 'b';
constexpr char kNoPermission = 'p';

char letter_of(base::ErrorKind kind) {
  switch (kind) {
    case base::ErrorKind::kUsage:
      return kUsage;
    case base::ErrorKind::kBusy:
      return kBusy;
    case base::ErrorKind::kNoPermission:
      return kNoPermission;
    case base::ErrorKind::kFailure:
    case base::ErrorKind::kInterrupted:
      return kFailure;
  }
  return kFailure;
}

base::ErrorKind kind_of(char letter) {
  switch (letter) {
    case kUsage:
      return base::ErrorKind::kUsage;
    case kBusy:
      return base::ErrorKind::kBusy;
    case kNoPermission:
      return base::ErrorKind::kNoPermission;
    default:
      return base::ErrorKind::kFailure;
  }
}

/// A finished record as the journal it could have come from.
class MemoryJournal {
 public:
  MemoryJournal(int file, const RecordHeader& header) : file_(file), builder_(named(header)) {}

  /// \throws std::runtime_error if there is no room.
  void write(Record record) {
    put(builder_.header(record.header));
    for_each_run(record, [&](std::size_t row, std::size_t count) {
      const daq::ScanIndex first = record.scan[row];
      put(builder_.scans(first, std::span{record.raw}.subspan(row, count), {}));
      if (!record.second.empty()) put(builder_.second(first, std::span{record.second}.subspan(row, count)));
      if (!record.true_coefficient.empty()) {
        put(builder_.true_coefficients(first, std::span{record.true_coefficient}.subspan(row, count)));
      }
    });
    for (const daq::Gap& gap : record.gaps) put(builder_.gap(gap));
    for (const ClockAnchor& anchor : record.anchors) put(builder_.anchor(anchor));
    for (const Event& event : record.events) put(builder_.event(event));
    EndRecord end = std::move(record.end).value();
    end.cycles = std::move(record.cycles);
    end.spikes = std::move(record.spikes);
    put(builder_.end(end));
  }

 private:
  /// A record that was thinned out may have lost its name, without which no journal begins.
  static RecordHeader named(RecordHeader header) {
    if (header.uuid.empty()) header.uuid = "none";
    return header;
  }

  /// Consecutive scans.
  template <typename Use>
  static void for_each_run(const Record& record, const Use& use) {
    for (std::size_t row = 0; row < record.scan.size();) {
      std::size_t count = 1;
      while (count < kMostScans && row + count < record.scan.size() &&
             record.scan[row + count] == record.scan[row] + static_cast<daq::ScanIndex>(count)) {
        ++count;
      }
      use(row, count);
      row += count;
    }
  }

  void put(EntryBuilder::Bytes entry) const {
    if (write_all(file_, entry, system_calls()) != entry.size())
      throw std::runtime_error("no memory for a record");
  }

  int file_;
  EntryBuilder builder_;
};

/// Set once, before there are threads.
struct Apart {
  bool wanted = false;
  std::function<bool()> given_up;
};

Apart& apart() {
  static Apart apart;
  return apart;
}

/// Of one thread: while one record is worked on, both read those that will be asked for next.
class PairOfReaders {
 public:
  /// \param words  of the reader's command line: its option, and what follows it.
  explicit PairOfReaders(const std::vector<std::string>& words) : readings_{reading(words), reading(words)} {}

  base::Result<Record> read(const std::string& path, std::span<const std::string> next) {
    std::size_t own = readings_[0].path == path ? 0 : 1;
    if (path.empty() || readings_[own].path != path) {
      own = !next.empty() && readings_[0].path == next[0] ? 1 : 0;
      if (auto begun = begin(readings_[own], path); !begun) return tl::unexpected(begun.error());
    }
    Reading& other = readings_[1 - own];
    if (!next.empty() && other.path != next[0]) try_begin(other, next[0]);
    readings_[own].path.clear();
    base::Result<Record> record = readings_[own].reader.finish(apart().given_up);
    if (next.size() > 1) try_begin(readings_[own], next[1]);
    return record;
  }

 private:
  struct Reading {
    ApartReader reader;
    std::string path;  ///< Of what it reads; empty: nothing.
  };

  [[nodiscard]] static base::Result<void> begin(Reading& reading, const std::string& path) {
    // Told here, in the words of all files, and before a child is asked.
    const base::Result<base::RegularFile> file = base::open_regular(path);
    if (!file) return tl::unexpected(file.error());
    reading.path.clear();
    auto begun = reading.reader.begin(path, base::limits_for_file(file->size));
    if (begun) reading.path = path;
    return begun;
  }

  /// What refuses it is told when it is asked for.
  static void try_begin(Reading& reading, const std::string& path) {
    static_cast<void>(begin(reading, path));
  }

  static Reading reading(const std::vector<std::string>& words) {
    return {ApartReader{base::LimitedChild{base::ChildProgram{"/proc/self/exe", words}}}, {}};
  }

  std::array<Reading, 2> readings_;
};

}  // namespace

base::Result<Record> ApartReader::read(const std::filesystem::path& path, const base::WorkLimits& limits,
                                       const std::function<bool()>& given_up) {
  if (auto begun = begin(path, limits); !begun) return tl::unexpected(begun.error());
  return finish(given_up);
}

base::Result<void> ApartReader::begin(const std::filesystem::path& path, const base::WorkLimits& limits) {
  path_ = path;
  auto begun = child_.begin(path.native(), limits);
  if (!begun) return base::failure("{}: {}", path.string(), begun.error().message);
  return begun;
}

base::Result<Record> ApartReader::finish(const std::function<bool()>& given_up) {
  const base::Result<std::string> answer = child_.answer(given_up);
  if (!answer) {
    std::string message = fmt::format("{}: {}", path_.string(), answer.error().message);
    if (answer.error().kind == base::ErrorKind::kUsage) {
      message +=
          fmt::format("; `stickslip verify {}` says what is damaged; take it from a backup", path_.string());
    }
    return tl::unexpected(base::Error{answer.error().kind, std::move(message), answer.error().worker_died});
  }
  if (answer->empty()) return base::failure("{}: its reader says nothing", path_.string());
  const char letter = answer->front();
  if (letter != kRead) return tl::unexpected(base::Error{kind_of(letter), answer->substr(1)});
  base::Result<JournalReading> reading = read_journal(child_.memory_file());
  if (!reading || !reading->record.end)
    return base::failure("{}: what its reader says cannot be read", path_.string());
  reading->record.sha256 = answer->substr(1);
  return std::move(reading->record);
}

namespace {

std::string answer_with(base::Result<Record> record, int memory_file) {
  if (!record) return letter_of(record.error().kind) + record.error().message;
  std::string answer = kRead + record->sha256;
  MemoryJournal journal{memory_file, record->header};
  journal.write(*std::move(record));
  return answer;
}

}  // namespace

std::string read_for_parent(std::string_view path, int memory_file) {
  return answer_with(read_record(path), memory_file);
}

std::string read_results_for_parent(std::string_view path, std::span<const std::string> only,
                                    int memory_file) {
  return answer_with(read_without_scans(path, only), memory_file);
}

std::string read_facts_for_parent(std::string_view path, int memory_file) {
  return answer_with(read_facts(path), memory_file);
}

void serve_if_reader(int count, char** arguments) {
  // A parent asks through a socket; whoever types the option has none.
  struct stat input {};
  if (count < 2 || ::fstat(STDIN_FILENO, &input) != 0 || !S_ISSOCK(input.st_mode)) return;
  if (arguments[1] == kResultsReaderOption) {
    base::answer_questions([only = std::vector<std::string>(arguments + 2, arguments + count)](
                               std::string_view path, int memory_file) {
      return read_results_for_parent(path, only, memory_file);
    });
  }
  if (count != 2) return;
  if (arguments[1] == kReaderOption) base::answer_questions(read_for_parent);
  if (arguments[1] == kFactsReaderOption) base::answer_questions(read_facts_for_parent);
}

void read_records_apart(std::function<bool()> given_up) { apart() = {true, std::move(given_up)}; }

base::Result<Record> read_record_apart(const std::string& path, std::span<const std::string> next) {
  if (!apart().wanted) return read_record(path);
  thread_local PairOfReaders readers{{std::string{kReaderOption}}};
  return readers.read(path, next);
}

base::Result<Record> read_results_apart(const std::string& path, std::span<const std::string> only,
                                        std::span<const std::string> next) {
  if (!apart().wanted) return read_without_scans(path, only);
  std::vector<std::string> words{std::string{kResultsReaderOption}};
  words.insert(words.end(), only.begin(), only.end());
  thread_local std::map<std::vector<std::string>, PairOfReaders> readers;
  return readers.try_emplace(words, words).first->second.read(path, next);
}

base::Result<Record> read_facts_apart(const std::string& path, std::span<const std::string> next) {
  if (!apart().wanted) return read_facts(path);
  thread_local PairOfReaders readers{{std::string{kFactsReaderOption}}};
  return readers.read(path, next);
}

base::Result<Record> read_record_in_turn(std::span<const std::string> files, std::size_t index) {
  return read_record_apart(files[index], files.subspan(index + 1));
}

}  // namespace stickslip::record
