#include "core/record/patient_journal.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <utility>

#include "core/record/finaliser.hpp"
#include "core/record/journal.hpp"
#include "core/record/journal_care.hpp"
#include "core/record/journal_name.hpp"

namespace stickslip::record {
namespace {

/// Largest single write; small, so that a nearly full disk is still used.
constexpr std::size_t kPiece = std::size_t{1} << 16U;

/// Bytes of whole entries at the front, at least one entry, else about kPiece.
std::size_t piece_of(std::span<const std::byte> entries) {
  std::size_t size = 0;
  while (size < entries.size()) {
    EntryHead head;
    std::memcpy(&head, entries.data() + size, sizeof head);
    const std::size_t entry = kEntryHeadSize + head.payload_size;
    if (size > 0 && size + entry > kPiece) break;
    size += entry;
  }
  return size;
}

/// Whether the file is what an attempt before left, because the disk refused to remove it as well: the
/// beginning of this header, in which stands a uuid that nobody else has.
bool is_own_leftover(const std::filesystem::path& path, std::span<const std::byte> header) {
  const auto content = read_file(path);
  return content && content->size() <= header.size() &&
         std::equal(content->begin(), content->end(), header.begin()) && JournalLock::take(path);
}

const RecordHeader& with_uuid(RecordHeader& header) {
  if (header.uuid.empty()) header.uuid = make_uuid();
  return header;
}

}  // namespace

PatientJournal::PatientJournal(std::filesystem::path path, RecordHeader header, std::size_t memory,
                               const FileCalls& calls)
    : calls_(&calls), memory_(memory), builder_(with_uuid(header)), path_(std::move(path)) {
  const EntryBuilder::Bytes entry = builder_.header(header);
  header_.assign(entry.begin(), entry.end());
}

// ---- adding -------------------------------------------------------------------------------

bool PatientJournal::has_room(std::size_t size) const { return waiting_.size() + in_hand_ + size <= memory_; }

void PatientJournal::keep(EntryBuilder::Bytes entry) {
  const std::lock_guard lock{mutex_};
  waiting_.insert(waiting_.end(), entry.begin(), entry.end());
}

bool PatientJournal::keep_if_room(EntryBuilder::Bytes entry) {
  const std::lock_guard lock{mutex_};
  if (!has_room(entry.size())) return false;
  waiting_.insert(waiting_.end(), entry.begin(), entry.end());
  return true;
}

void PatientJournal::tell_lost() {
  for (const LostScans& lost : std::exchange(lost_, {})) {
    keep(builder_.gap({lost.first, lost.count, false, daq::GapCause::kStorageFull}));
  }
}

bool PatientJournal::add_scans(daq::ScanIndex first, std::span<const double> raw,
                               const daq::ClockStamp& stamp, std::span<const std::int32_t> second) {
  const auto count = static_cast<std::int64_t>(raw.size());
  const EntryBuilder::Bytes entry = builder_.scans(first, raw, stamp);
  {
    const std::lock_guard lock{mutex_};
    const std::size_t second_size = second.empty() ? 0 : kEntryHeadSize + second.size_bytes();
    if (!has_room(entry.size() + second_size)) {
      lost_count_ += count;
      if (!lost_.empty() && lost_.back().first + lost_.back().count == first) {
        lost_.back().count += count;
      } else {
        lost_.push_back({first, count});
      }
      return false;
    }
    kept_count_ += count;
  }
  if (lost_.empty()) {
    keep(entry);
  } else {
    const std::vector<std::byte> scans(entry.begin(), entry.end());  // The gap is built in the same room.
    tell_lost();
    keep(scans);
  }
  if (!second.empty()) keep(builder_.second(first, second));
  return true;
}

bool PatientJournal::add_true_coefficients(daq::ScanIndex first, std::span<const double> coefficient) {
  return keep_if_room(builder_.true_coefficients(first, coefficient));
}

bool PatientJournal::add_cycle(const detect::Cycle& cycle) { return keep_if_room(builder_.cycle(cycle)); }

bool PatientJournal::add_anchor(const ClockAnchor& anchor) { return keep_if_room(builder_.anchor(anchor)); }

bool PatientJournal::add_event(const Event& event) { return keep_if_room(builder_.event(event)); }

void PatientJournal::add_gap(const daq::Gap& gap) { keep(builder_.gap(gap)); }

void PatientJournal::add_end(EndRecord end) {
  tell_lost();
  if (const std::int64_t lost = lost_scan_count(); lost > 0) {
    end.status = Status::kIncomplete;
    end.reasons.push_back(fmt::format("{} scans could not be stored: the disk refused them", lost));
  }
  keep(builder_.end(end));
}

bool PatientJournal::wait_for_room(std::chrono::milliseconds longest) const {
  std::unique_lock lock{mutex_};
  return taken_.wait_for(lock, longest, [this] { return has_room(memory_ / 2); });
}

std::int64_t PatientJournal::kept_scan_count() const {
  const std::lock_guard lock{mutex_};
  return kept_count_;
}

std::int64_t PatientJournal::lost_scan_count() const {
  const std::lock_guard lock{mutex_};
  return lost_count_;
}

std::size_t PatientJournal::waiting_size() const {
  const std::lock_guard lock{mutex_};
  return waiting_.size() + in_hand_;
}

std::filesystem::path PatientJournal::path() const {
  const std::lock_guard lock{mutex_};
  return path_;
}

// ---- writing ------------------------------------------------------------------------------

void PatientJournal::move_to(const std::filesystem::path& path) {
  const std::lock_guard lock{mutex_};
  path_ = path;
}

std::optional<std::string> PatientJournal::open() {
  if (file_) return std::nullopt;
  if (auto made = make_folders(path_.parent_path(), *calls_); !made) return made.error().message;
  if (is_own_leftover(path_, header_)) {
    calls_->unlink(path_.c_str());
  } else {
    move_to(free_journal_path(path_));
  }
  auto file = JournalFile::create(path_, header_, *calls_);
  if (!file) return file.error().message;
  file_.emplace(*std::move(file));
  synced_size_ = file_->size();
  return std::nullopt;
}

std::optional<std::string> PatientJournal::write() {
  if (auto trouble = open()) return trouble;
  std::vector<std::byte> entries;
  {
    const std::lock_guard lock{mutex_};
    entries = std::exchange(waiting_, {});
    in_hand_ = entries.size();
  }
  std::size_t done = 0;
  std::optional<std::string> trouble;
  while (done < entries.size() && !trouble) {
    const auto rest = std::span<const std::byte>{entries}.subspan(done);
    const auto piece = rest.first(piece_of(rest));
    if (const auto written = file_->append(piece)) {
      unsynced_.insert(unsynced_.end(), piece.begin(), piece.end());
      done += piece.size();
    } else {
      trouble = written.error().message;
    }
  }
  {
    const std::lock_guard lock{mutex_};
    if (done < entries.size()) {
      entries.erase(entries.begin(), entries.begin() + static_cast<std::ptrdiff_t>(done));
      entries.insert(entries.end(), waiting_.begin(), waiting_.end());
      waiting_ = std::move(entries);
    }
    in_hand_ = 0;
  }
  taken_.notify_all();
  return trouble;
}

std::optional<std::string> PatientJournal::save() {
  if (auto astray = ensure_at_path()) return astray;
  std::optional<std::string> trouble = write();
  if (!file_ || unsynced_.empty()) return trouble;
  if (const auto synced = file_->sync()) {
    synced_size_ = file_->size();
    unsynced_.clear();
    return trouble;
  } else if (!trouble) {
    trouble = synced.error().message;
  }
  // After a failed sync it is unknown which part is on disk; all of it is written again.
  file_->cut_to(synced_size_);
  const std::lock_guard lock{mutex_};
  unsynced_.insert(unsynced_.end(), waiting_.begin(), waiting_.end());
  waiting_ = std::exchange(unsynced_, {});
  return trouble;
}

std::optional<std::string> PatientJournal::ensure_at_path() {
  if (!file_) return std::nullopt;
  switch (file_->place()) {
    case JournalFile::Place::kItself:
      return std::nullopt;
    case JournalFile::Place::kUnknown:
      return fmt::format("{}: cannot be looked at: {}", path_.string(), system_message(errno));
    case JournalFile::Place::kNothing:
    case JournalFile::Place::kAnother:
      break;
  }
  // The finaliser removes the journal after the record is published.
  std::error_code ignored;
  if (handed_over_ && std::filesystem::exists(record_of(path_), ignored)) return std::nullopt;
  return write_anew();
}

std::optional<std::string> PatientJournal::write_anew() {
  if (auto made = make_folders(path_.parent_path(), *calls_); !made) return made.error().message;
  const std::filesystem::path path = free_journal_path(path_);
  auto copy = file_->copy_to(path);
  if (!copy) return copy.error().message;
  file_.emplace(*std::move(copy));
  synced_size_ = file_->size();
  unsynced_.clear();
  move_to(path);
  ++anew_count_;
  if (handed_over_) hand_over();
  return std::nullopt;
}

void PatientJournal::give_room_back() {
  if (file_) file_->give_room_back();
}

void PatientJournal::hand_over() {
  handed_over_ = true;
  give_room_back();
  if (file_) file_->unlock();
}

}  // namespace stickslip::record
