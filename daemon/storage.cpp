#include "daemon/storage.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

namespace stickslip::daemon {
namespace {

/// Messages between processing and storage: half a minute of blocks at 350 scans/s.
constexpr std::size_t kQueueCapacity = 4096;
/// At most this much is lost at a power cut.
constexpr std::chrono::seconds kSyncPeriod{1};
/// One journal entry holds this much time.
constexpr double kEntry_s = 0.1;

/// Scans in one journal entry of the noise-free force: 32 kB.
constexpr std::size_t kForceEntry = 4096;

/// "20261121T125252Z-0003", in UTC; a number is added while something of that name exists.
std::filesystem::path free_journal_path(const std::filesystem::path& folder,
                                        const pipeline::TestStart& start) {
  const std::time_t seconds = start.stamp.realtime_ns / 1'000'000'000;
  const std::string stem = fmt::format("{:%Y%m%dT%H%M%SZ}-{:04}", fmt::gmtime(seconds), start.number);
  std::error_code error;
  for (int attempt = 1;; ++attempt) {
    const std::string name = attempt == 1 ? stem : fmt::format("{}-{}", stem, attempt);
    std::filesystem::path journal = folder / (name + std::string{record::kJournalExtension});
    if (!std::filesystem::exists(journal, error) &&
        !std::filesystem::exists(folder / (name + ".h5"), error)) {
      return journal;
    }
  }
}

}  // namespace

Storage::Storage(std::filesystem::path folder, Finalise finalise, TestLog& tests, Facts& facts)
    : folder_(std::move(folder)),
      finalise_(std::move(finalise)),
      tests_(tests),
      facts_(facts),
      queue_(kQueueCapacity),
      thread_([this] { run(); }) {}

Storage::~Storage() { stop(); }

void Storage::use(record::RecordHeader header, const friction::TruthSource* truth) {
  header_ = std::make_shared<const record::RecordHeader>(std::move(header));
  truth_ = truth;
}

void Storage::stop() {
  if (!thread_.joinable()) return;
  queue_.push(Quit{});
  thread_.join();
}

// Processing thread.

void Storage::test_began(const pipeline::TestStart& start) {
  first_ = start.first;
  queue_.push(Began{start, header_});
}

void Storage::scans(daq::ScanIndex first, std::span<const double> raw, std::span<const std::int32_t> second,
                    const daq::ClockStamp& stamp) {
  while (!raw.empty()) {
    daq::ScanBlock block;
    block.first = first;
    block.stamp = stamp;
    block.count = static_cast<std::uint32_t>(std::min(raw.size(), daq::ScanBlock::kMaxScans));
    std::copy_n(raw.begin(), block.count, block.raw.begin());
    block.has_second = !second.empty();
    if (block.has_second) {
      std::copy_n(second.begin(), block.count, block.second.begin());
      second = second.subspan(block.count);
    }
    queue_.push(block);
    first = block.end();
    raw = raw.subspan(block.count);
  }
}

void Storage::gap(const daq::Gap& gap) { queue_.push(gap); }

void Storage::anchor(const daq::ClockAnchor& anchor) { queue_.push(anchor); }

void Storage::cycle(const friction::Cycle& cycle) { queue_.push(cycle); }

void Storage::test_ended(const pipeline::TestEnd& end) {
  auto record = std::make_shared<record::EndRecord>();
  record->cause = pipeline::name(end.cause);
  record->results = end.results;
  record->cycles = end.cycles;
  record->spikes = end.spikes;
  record->read_latency = end.read_latency;
  std::shared_ptr<friction::TrueForce> force;
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
  for (;;) {
    Message message;
    if (queue_.pop(message, kSyncPeriod)) {
      if (std::holds_alternative<Quit>(message)) return;
      std::visit(
          [this](const auto& content) {
            if constexpr (!std::is_same_v<std::decay_t<decltype(content)>, Quit>) handle(content);
          },
          message);
    }
    sync_if_due();
  }
}

void Storage::handle(const Began& message) {
  number_ = message.start.number;
  failed_.reset();
  pending_.clear();
  pending_second_.clear();
  recorded_.clear();
  record::RecordHeader header = *message.header;
  header.test_number = message.start.number;
  header.trigger_scan = message.start.trigger;
  header.start_realtime_ns = message.start.stamp.realtime_ns;
  header.title = fmt::format("test {}", message.start.number);
  const double rate_Hz = header.board.scan_rate_granted_Hz;
  pending_enough_ = static_cast<std::size_t>(std::max(1.0, std::floor(rate_Hz * kEntry_s)));
  auto journal = record::JournalWriter::create(free_journal_path(folder_, message.start), std::move(header));
  if (journal) {
    journal_.emplace(std::move(*journal));
  } else {
    fail(journal.error().message);
  }
  last_sync_ = std::chrono::steady_clock::now();
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
  if (journal_ && !failed_) note(journal_->append_gap(gap));
}

void Storage::handle(const daq::ClockAnchor& anchor) {
  if (journal_ && !failed_) note(journal_->append_anchor(anchor));
}

void Storage::handle(const friction::Cycle& cycle) {
  append_pending();
  if (journal_ && !failed_) note(journal_->append_cycle(cycle));
}

void Storage::handle(const Ended& message) {
  append_pending();
  if (!journal_) {
    tests_.set_file_error(number_, failed_.value_or("not recorded"));
    return;
  }
  record::EndRecord end = *message.end;
  end.end_realtime_ns = pending_stamp_.realtime_ns;
  if (failed_) {
    end.status = record::Status::kIncomplete;
    end.reasons.push_back(*failed_);
  }
  base::Result<void> written;
  if (message.force && !failed_) written = append_force(*message.force);
  if (written) written = journal_->append_end(end);
  if (written) written = journal_->sync();
  const std::filesystem::path path = journal_->path();
  journal_.reset();
  if (!written) {
    fail(written.error().message);
    tests_.set_file_error(number_, written.error().message);
    return;
  }
  const base::Result<std::filesystem::path> file = finalise_(path);
  if (file) {
    tests_.set_file(number_, file->string());
    facts_.file_published(number_, *file);
  } else {
    fail(file.error().message);
    tests_.set_file_error(number_, file.error().message);
  }
}

void Storage::append_pending() {
  if (journal_ && !failed_ && !pending_.empty()) {
    base::Result<void> appended = journal_->append_scans(pending_first_, pending_, pending_stamp_);
    if (appended && !pending_second_.empty()) {
      appended = journal_->append_second(pending_first_, pending_second_);
    }
    note(appended);
    // The stamp belongs to the last scan of the last block.
    const daq::ScanIndex last = pending_first_ + static_cast<daq::ScanIndex>(pending_.size()) - 1;
    if (!recorded_.empty() && recorded_.back().end == pending_first_) {
      recorded_.back().end = last + 1;
    } else {
      recorded_.push_back({pending_first_, last + 1});
    }
  }
  pending_.clear();
  pending_second_.clear();
}

base::Result<void> Storage::append_force(friction::TrueForce& force) {
  std::array<double, kForceEntry> coefficient{};
  for (Stretch stretch : recorded_) {
    while (stretch.first < stretch.end) {
      const auto left = static_cast<std::size_t>(stretch.end - stretch.first);
      const std::span<double> some = std::span{coefficient}.first(std::min(left, kForceEntry));
      force.next(stretch.first, some);
      if (auto written = journal_->append_true_coefficients(stretch.first, some); !written) return written;
      stretch.first += static_cast<daq::ScanIndex>(some.size());
    }
  }
  return {};
}

void Storage::sync_if_due() {
  const auto now = std::chrono::steady_clock::now();
  if (!journal_ || failed_ || now - last_sync_ < kSyncPeriod) return;
  append_pending();
  if (!failed_) note(journal_->sync());
  last_sync_ = now;
}

void Storage::note(const base::Result<void>& written) {
  if (!written) fail(written.error().message);
}

void Storage::fail(const std::string& why) {
  if (!failed_) facts_.recording_failed(number_, why);
  failed_ = why;
}

}  // namespace stickslip::daemon
