#include "drivers/replay/replay_board.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <utility>

#include "core/base/contract.hpp"

namespace stickslip::drivers {
namespace {

constexpr double kNanosecondsPerSecond = 1e9;

class ReplayBoard final : public daq::Board {
 public:
  ReplayBoard(record::Record record, base::Clock& clock)
      : info_(std::move(record.header.board)),
        scan_(std::move(record.scan)),
        raw_(std::move(record.raw)),
        second_(std::move(record.second)),
        clock_(clock) {
    info_.driver = "replay";
  }

  [[nodiscard]] const daq::BoardInfo& info() const noexcept override { return info_; }

  [[nodiscard]] base::Result<void> start() override {
    if (!running_) {
      running_ = true;
      started_ns_ = clock_.monotonic_ns();
      if (next_ < scan_.size()) origin_ = scan_[next_];
    }
    return {};
  }

  [[nodiscard]] daq::ReadStatus read(daq::ScanBlock& block,
                                     std::chrono::milliseconds timeout) noexcept override {
    block.count = 0;
    if (running_ && next_ == scan_.size()) return daq::ReadStatus::kEndOfInput;
    const std::int64_t deadline_ns = clock_.monotonic_ns() + std::chrono::nanoseconds{timeout}.count();
    clock_.sleep_until(running_ ? std::min(deadline_ns, due_ns(scan_[next_])) : deadline_ns);
    const std::int64_t now_ns = clock_.monotonic_ns();
    if (!running_ || due_ns(scan_[next_]) > now_ns) return daq::ReadStatus::kTimeout;

    block.first = scan_[next_];
    while (block.count < daq::ScanBlock::kMaxScans && next_ < scan_.size() && scan_[next_] == block.end() &&
           due_ns(scan_[next_]) <= now_ns) {
      if (!second_.empty()) block.second[block.count] = second_[next_];
      block.raw[block.count++] = raw_[next_++];
    }
    block.has_second = !second_.empty();
    block.stamp = {now_ns, clock_.realtime_ns()};
    return daq::ReadStatus::kScans;
  }

  void stop() noexcept override { running_ = false; }

 private:
  /// By the index, so that a gap takes the time it took.
  [[nodiscard]] std::int64_t due_ns(daq::ScanIndex scan) const noexcept {
    const double elapsed_s = static_cast<double>(scan - origin_ + 1) / info_.scan_rate_granted_Hz;
    return started_ns_ + static_cast<std::int64_t>(std::llround(elapsed_s * kNanosecondsPerSecond));
  }

  daq::BoardInfo info_;
  std::vector<daq::ScanIndex> scan_;
  std::vector<double> raw_;
  std::vector<std::int32_t> second_;  ///< Empty unless info_.second.
  base::Clock& clock_;
  bool running_ = false;
  std::size_t next_ = 0;
  daq::ScanIndex origin_ = 0;  ///< Due one period after started_ns_.
  std::int64_t started_ns_ = 0;
};

/// The record's noise-free force; columns of equal length.
struct ForceTable {
  std::vector<daq::ScanIndex> scan;
  std::vector<double> coefficient;
};

class RecordedForce final : public model::TrueForce {
 public:
  explicit RecordedForce(std::shared_ptr<const ForceTable> table) : table_(std::move(table)) {}

  void next(base::ScanIndex first, std::span<double> coefficient) override {
    const std::vector<daq::ScanIndex>& scan = table_->scan;
    auto row = static_cast<std::size_t>(std::lower_bound(scan.begin(), scan.end(), first) - scan.begin());
    for (double& value : coefficient) {
      const bool known = row < scan.size() && scan[row] == first;
      value = known ? table_->coefficient[row++] : std::numeric_limits<double>::quiet_NaN();
      ++first;
    }
  }

 private:
  std::shared_ptr<const ForceTable> table_;
};

/// The record's truth, with times relative to the first scan that is asked for.
class RecordedTruth final : public model::TruthSource {
 public:
  /// \param force  null if the record has none.
  RecordedTruth(std::optional<model::TestTruth> truth, daq::ScanIndex first, daq::ScanIndex end,
                double rate_Hz, std::shared_ptr<const ForceTable> force)
      : truth_(std::move(truth)), first_(first), end_(end), rate_Hz_(rate_Hz), force_(std::move(force)) {}

  [[nodiscard]] std::optional<model::TestTruth> truth(base::ScanIndex first,
                                                      base::ScanIndex end) const override {
    if (!truth_ || first >= end_ || end <= first_) return std::nullopt;
    model::TestTruth moved = *truth_;
    const double shift_s = static_cast<double>(first_ - first) / rate_Hz_;
    for (auto& mode : moved.modes) {
      mode.start_s += shift_s;
      mode.end_s += shift_s;
    }
    for (auto& cycle : moved.cycles) cycle.onset_time_s += shift_s;
    return moved;
  }

  [[nodiscard]] std::unique_ptr<model::TrueForce> force(base::ScanIndex first) const override {
    if (!force_ || first >= end_) return nullptr;
    return std::make_unique<RecordedForce>(force_);
  }

 private:
  std::optional<model::TestTruth> truth_;
  daq::ScanIndex first_;
  daq::ScanIndex end_;
  double rate_Hz_;
  std::shared_ptr<const ForceTable> force_;
};

}  // namespace

Replay make_replay(record::Record record, base::Clock& clock) {
  STICKSLIP_EXPECTS(record.scan.size() == record.raw.size());
  const double rate_Hz = record.header.board.scan_rate_granted_Hz;
  STICKSLIP_EXPECTS(rate_Hz > 0.0 && std::isfinite(rate_Hz));
  const daq::ScanIndex first = record.scan.empty() ? 0 : record.scan.front();
  const daq::ScanIndex end = record.scan.empty() ? 0 : record.scan.back() + 1;
  std::optional<model::TestTruth> truth;
  if (record.end) truth = std::move(record.end->truth);
  std::shared_ptr<const ForceTable> force;
  if (!record.true_coefficient.empty()) {
    STICKSLIP_EXPECTS(record.true_coefficient.size() == record.scan.size());
    force = std::make_shared<const ForceTable>(ForceTable{record.scan, std::move(record.true_coefficient)});
  }
  return {std::make_unique<ReplayBoard>(std::move(record), clock),
          std::make_unique<RecordedTruth>(std::move(truth), first, end, rate_Hz, std::move(force))};
}

}  // namespace stickslip::drivers
