#include "daemon/storage/storage.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <ctime>
#include <span>
#include <utility>

#include "io/record_name.hpp"

#include "core/base/thread_name.hpp"
#include "core/record/enum_names.hpp"
#include "core/record/iso_time.hpp"
#include "core/record/journal.hpp"
#include "core/record/journal_name.hpp"
#include "daemon/storage/finaliser_process.hpp"

namespace stickslip::storage {
namespace {

/// Capacity of the queue from the processing to the storage thread, messages: half a minute of blocks at 350
/// scans/s.
constexpr std::size_t kQueueCapacity = 4096;
/// Longest wait of the storage thread for a message.
constexpr std::chrono::seconds kIdle{1};
/// Time that one journal entry of scans holds.
constexpr double kEntry_s = 0.1;

/// Scans in one journal entry of the noise-free force: 32 kB.
constexpr std::size_t kForceEntry = 4096;

/// Time of scanning that memory holds while the disk refuses: scans with their gaps, cycles and clock
/// readings.
constexpr double kLongestWait_s = 600.0;

std::size_t scans_in_entry(const daq::BoardInfo& board) {
  return static_cast<std::size_t>(std::max(1.0, std::floor(board.scan_rate_granted_Hz * kEntry_s)));
}

double encoded_size(const daq::BoardInfo& board) {
  if (board.quantity != daq::RawQuantity::kCounts) return sizeof(double);
  return record::counts_fit_u16(board) ? sizeof(std::uint16_t) : sizeof(std::uint32_t);
}

/// Growth of journal and record together for one scan. The record's columns are time, scan, value, force and
/// flags, uncompressed.
double bytes_per_scan(const daq::BoardInfo& board) {
  constexpr double kColumns = sizeof(double) + sizeof(std::int64_t) + sizeof(float) + sizeof(std::uint8_t);
  return 2.0 * encoded_size(board) + kColumns;
}

std::filesystem::path dated(const StorageSettings& settings, std::time_t seconds) {
  switch (settings.dated_folders) {
    case io::DatedFolders::kNone:
      break;
    case io::DatedFolders::kMonth:
      return settings.folder / fmt::format("{:%Y}", fmt::gmtime(seconds)) /
             fmt::format("{:%m}", fmt::gmtime(seconds));
    case io::DatedFolders::kDay:
      return settings.folder / fmt::format("{:%Y-%m-%d}", fmt::gmtime(seconds));
  }
  return settings.folder;
}

std::filesystem::path journal_path(const StorageSettings& settings, const pipeline::TestStart& start,
                                   const std::filesystem::path& latest) {
  const std::time_t seconds = start.stamp.realtime_ns / 1'000'000'000;
  const std::filesystem::path folder = dated(settings, seconds);
  const std::string name = io::record_stem(seconds, start.number) + std::string{record::kJournalExtension};
  return record::free_journal_path(folder / name, latest);
}

}  // namespace

Storage::Storage(StorageSettings settings, Finalise finalise, daemon::TestLog& tests,
                 daemon::EventReceiver& events, std::function<void()> changed, Made made)
    : settings_(std::move(settings)),
      tests_(tests),
      events_(events),
      queue_(kQueueCapacity),
      changed_(std::move(changed)),
      made_(std::move(made)),
      finisher_(
          [this, finalise = std::move(finalise)](std::int64_t test, std::int64_t scans) {
            return disk_.make_record(
                test, [&](const std::filesystem::path& journal) { return finalise(journal, scans); });
          },
          [this](std::int64_t test, std::int64_t scans, const base::Result<record::Finalised>& finalised) {
            journal_finalised(test, scans, finalised);
          }),
      disk_(
          {.folder = settings_.folder,
           .sync_period = settings_.sync_period,
           .calls = settings_.calls,
           .written_anew =
               [this](std::int64_t test, const std::filesystem::path& before,
                      const std::filesystem::path& now) { events_.journal_written_anew(test, before, now); }},
          [this](std::int64_t test, const std::filesystem::path& /*journal*/, std::int64_t scans,
                 const std::optional<std::string>& why_not) { journal_ended(test, scans, why_not); },
          [this](const DiskState& state) { disk_changed(state); }),
      thread_([this] { run(); }) {}

Storage::~Storage() { stop(); }

void Storage::use(record::RecordHeader header, const model::TruthSource* truth,
                  std::vector<std::string> remarks) {
  disk_.set_load(header.board.scan_rate_granted_Hz * bytes_per_scan(header.board) + kOtherBytesPerSecond);
  header_ = std::make_shared<const record::RecordHeader>(std::move(header));
  truth_ = truth;
  remarks_ = std::move(remarks);
}

void Storage::amend(const std::function<void(record::RecordHeader&)>& change) {
  if (!header_) return;
  record::RecordHeader header = *header_;
  change(header);
  header_ = std::make_shared<const record::RecordHeader>(std::move(header));
}

void Storage::stop() {
  if (!thread_.joinable()) return;
  queue_.push(Quit{});
  thread_.join();
  disk_.stop();
  finisher_.stop();
  disk_.close_account();
}

// Processing thread.

void Storage::test_began(const pipeline::TestStart& start) {
  first_ = start.first;
  collected_.count = 0;
  collected_cycles_.clear();
  // The queue is told of an entry, not of each scan or cycle.
  collected_enough_ = std::min(scans_in_entry(header_->board), daq::ScanBlock::kMaxScans);
  queue_.push(Began{start, header_, remarks_});
}

void Storage::scans(daq::ScanIndex first, std::span<const double> raw, std::span<const std::int32_t> second,
                    const daq::ClockStamp& stamp) {
  while (!raw.empty()) {
    if (collected_.count > 0 && collected_.end() != first) hand_over_collected();
    if (collected_.count == 0) collected_.first = first;
    const std::size_t count = std::min(raw.size(), daq::ScanBlock::kMaxScans - collected_.count);
    std::copy_n(raw.begin(), count, collected_.raw.begin() + collected_.count);
    raw = raw.subspan(count);
    collected_.has_second = !second.empty();
    if (collected_.has_second) {
      std::copy_n(second.begin(), count, collected_.second.begin() + collected_.count);
      second = second.subspan(count);
    }
    collected_.stamp = stamp;
    collected_.count += static_cast<std::uint32_t>(count);
    first = collected_.end();
    if (collected_.count >= collected_enough_) hand_over_collected();
  }
}

void Storage::hand_over_collected() {
  if (collected_.count > 0) queue_.put(collected_);
  collected_.count = 0;
  for (const detect::Cycle& cycle : collected_cycles_) queue_.put(cycle);
  collected_cycles_.clear();
  queue_.announce();
}

void Storage::gap(const daq::Gap& gap) {
  hand_over_collected();
  queue_.push(gap);
}

void Storage::anchor(const daq::ClockAnchor& anchor) {
  hand_over_collected();
  queue_.push(anchor);
}

void Storage::cycle(const detect::Cycle& cycle) { collected_cycles_.push_back(cycle); }

void Storage::note(const daq::Note& note) {
  hand_over_collected();
  queue_.push(note);
}

void Storage::test_ended(const pipeline::TestEnd& end) {
  hand_over_collected();
  auto record = std::make_shared<record::EndRecord>();
  record->cause = pipeline::name(end.cause);
  record->results = end.results;
  record->cycles = end.cycles;
  record->spikes = end.spikes;
  record->read_latency = end.read_latency;
  record->unloaded_level = end.unloaded_level;
  std::shared_ptr<model::TrueForce> force;
  if (end.cause == pipeline::EndCause::kBoardMissing) {
    record->status = record::Status::kIncomplete;
    record->reasons.emplace_back("the board went away before the end of the test");
  } else if (end.cause == pipeline::EndCause::kStopped) {
    record->status = record::Status::kInterrupted;
    record->reasons.emplace_back(record::kInterruptedWhy);
  }
  if (truth_ != nullptr) record->truth = truth_->truth(first_, end.end);
  if (record->truth) force = truth_->force(first_);
  queue_.push(Ended{std::move(record), std::move(force)});
}

// Storage thread.

void Storage::run() {
  base::name_this_thread("storage");
  for (;;) {
    rounds_.fetch_add(1, std::memory_order_relaxed);
    Message message;
    if (!queue_.pop(message, kIdle)) {
      append_pending();
      continue;
    }
    if (std::holds_alternative<Quit>(message)) return;
    std::visit(
        [this](const auto& content) {
          if constexpr (!std::is_same_v<std::decay_t<decltype(content)>, Quit>) handle(content);
        },
        message);
  }
}

std::optional<double> Storage::little_room_s() const {
  const std::optional<double> room_s = disk_.room_s();
  return room_s && *room_s < kLeastRoom_s ? room_s : std::nullopt;
}

void Storage::handle(const Began& message) {
  number_ = message.start.number;
  pending_.clear();
  pending_second_.clear();
  recorded_.clear();
  record::RecordHeader header = *message.header;
  header.test_number = message.start.number;
  header.trigger_scan = message.start.trigger;
  header.start_realtime_ns = message.start.stamp.realtime_ns;
  header.title = fmt::format("test {}", message.start.number);
  header.uuid = record::make_uuid();
  if (message.start.self_check) header.self_check = *message.start.self_check;
  header.plan.unloaded_level = message.start.unloaded_level;
  const std::string expires = header.calibration.expires;
  begun_ = header;
  const std::optional<double> little_s = little_room_s();
  if (little_s) events_.little_room(number_, *little_s);
  const double rate_Hz = header.board.scan_rate_granted_Hz;
  pending_enough_ = scans_in_entry(header.board);
  const auto memory = static_cast<std::size_t>(kLongestWait_s *
                                               (rate_Hz * encoded_size(header.board) + kOtherBytesPerSecond));
  const std::size_t others = disk_.waiting_size();
  latest_path_ = journal_path(settings_, message.start, latest_path_);
  journal_ = std::make_shared<record::PatientJournal>(
      latest_path_, std::move(header), memory > others ? memory - others : 0, *settings_.calls);
  disk_.begin(number_, journal_);
  const pipeline::TestStart& start = message.start;
  const auto event = [&](std::string text) {
    note_event(start.trigger, start.stamp.realtime_ns, std::move(text));
  };
  event(start.by_command ? "test began: somebody started it" : "test began: the force crossed the trigger");
  for (const std::string& remark : message.remarks) event(remark);
  if (!expires.empty() && record::iso_time(start.stamp.realtime_ns) >= expires) {
    event(fmt::format("the calibration of the load cell expired on {}", expires));
  }
  if (little_s) event(fmt::format("storage short: room on the disk for {:.0f} s of tests", *little_s));
  if (start.self_check) {
    for (const std::string& finding : start.self_check->findings) event("self-check: " + finding);
  }
}

void Storage::handle(const daq::ScanBlock& block) {
  if (!journal_) return;
  if (!pending_.empty() && block.first != pending_first_ + static_cast<daq::ScanIndex>(pending_.size())) {
    append_pending();
  }
  if (pending_.empty()) pending_first_ = block.first;
  pending_.insert(pending_.end(), block.scans().begin(), block.scans().end());
  pending_second_.insert(pending_second_.end(), block.second_codes().begin(), block.second_codes().end());
  pending_stamp_ = block.stamp;
  if (pending_.size() >= pending_enough_) append_pending();
}

void Storage::handle(const daq::Gap& gap) {
  append_pending();
  if (journal_) journal_->add_gap(gap);
  note_event(gap.first, pending_stamp_.realtime_ns,
             fmt::format("gap: {} scans missing: {}", gap.count, daq::name(gap.cause)));
}

void Storage::handle(const daq::ClockAnchor& anchor) {
  append_pending();  // An anchor follows the scan that it belongs to.
  if (journal_) journal_->add_anchor(anchor);
}

void Storage::handle(const detect::Cycle& cycle) {
  append_pending();
  if (journal_) journal_->add_cycle(cycle);
}

void Storage::handle(const daq::Note& note) {
  note_event(note.scan, pending_stamp_.realtime_ns, daq::to_text(note));
}

void Storage::handle(const Ended& message) {
  append_pending();
  if (!recorded_.empty()) {
    note_event(recorded_.back().end - 1, pending_stamp_.realtime_ns, "test ended: " + message.end->cause);
  }
  record::EndRecord end = *message.end;
  // By the scans: the date may have been set since.
  if (!recorded_.empty()) end.end_realtime_ns = record::realtime_at(begun_, recorded_.back().end);
  if (message.force) append_force(*message.force);
  if (end_told_) end_told_(begun_, end, record_of(journal_->path()));
  journal_->add_end(std::move(end));
  disk_.end(std::exchange(journal_, nullptr));
}

void Storage::note_event(daq::ScanIndex scan, std::int64_t realtime_ns, std::string text) {
  if (journal_) journal_->add_event({scan, realtime_ns, std::move(text)});
}

void Storage::append_pending() {
  if (journal_ && !pending_.empty()) {
    // The stamp belongs to the last scan of the last block.
    const daq::ScanIndex end = pending_first_ + static_cast<daq::ScanIndex>(pending_.size());
    if (journal_->add_scans(pending_first_, pending_, pending_stamp_, pending_second_)) {
      if (!recorded_.empty() && recorded_.back().end == pending_first_) {
        recorded_.back().end = end;
      } else {
        recorded_.push_back({pending_first_, end});
      }
    }
    disk_.wake();
  }
  pending_.clear();
  pending_second_.clear();
}

void Storage::append_force(model::TrueForce& force) {
  std::array<double, kForceEntry> coefficient{};
  for (Stretch stretch : recorded_) {
    while (stretch.first < stretch.end) {
      const auto left = static_cast<std::size_t>(stretch.end - stretch.first);
      const std::span<double> some = std::span{coefficient}.first(std::min(left, kForceEntry));
      force.next(stretch.first, some);
      // This is faster than the disk. If the disk refuses, the record lacks the noise-free force.
      while (!journal_->add_true_coefficients(stretch.first, some)) {
        disk_.wake();
        if (!journal_->wait_for_room(kIdle) && disk_.state().trouble) return;
      }
      stretch.first += static_cast<daq::ScanIndex>(some.size());
    }
  }
}

// Disk thread.

void Storage::journal_ended(std::int64_t test, std::int64_t scans,
                            const std::optional<std::string>& why_not) {
  if (!why_not) {
    finisher_.finish(test, scans);
    return;
  }
  record_made(test, base::failure("{}", *why_not));
}

void Storage::disk_changed(const DiskState& state) {
  const std::string why = daemon::why_no_test(storage_state(state, settings_.folder)).value_or("");
  // Another remedy is another trouble.
  if (state.trouble && (!waits_ || state.to_do != waits_for_)) events_.storage_waits(why);
  if (!state.trouble && waits_) events_.storage_resumed();
  waits_ = state.trouble.has_value();
  waits_for_ = state.to_do;
  if (state.is_short && !is_short_) events_.storage_short(why);
  if (!state.is_short && is_short_) events_.storage_has_room();
  is_short_ = state.is_short;
  if (changed_) changed_();
}

// The finisher's thread, or the disk's where there is nothing to finish.

void Storage::journal_finalised(std::int64_t test, std::int64_t scans,
                                const base::Result<record::Finalised>& made) {
  if (!made) return record_made(test, tl::unexpected(made.error()));
  record_made(test, made->file);
  damaged_scans_ += std::max<std::int64_t>(scans - made->scan_count, 0);
  if (const std::string loss = loss_of(*made, scans); !loss.empty()) events_.record_damaged(made->file, loss);
}

DiskWriter::ScanCounts Storage::scan_counts() const {
  DiskWriter::ScanCounts counts = disk_.scan_counts();
  counts.damaged = damaged_scans_;
  counts.recorded -= counts.damaged;
  return counts;
}

void Storage::record_made(std::int64_t test, const base::Result<std::filesystem::path>& file) {
  if (file) {
    tests_.set_file(test, file->string());
    events_.file_published(test, *file);
  } else {
    events_.recording_failed(test, file.error().message);
    tests_.set_file_error(test, file.error().message);
  }
  if (made_) made_(test, file);
}

}  // namespace stickslip::storage
