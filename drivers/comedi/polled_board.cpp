#include "drivers/comedi/polled_board.hpp"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <optional>
#include <utility>

#include "drivers/comedi/comedi_errors.hpp"

namespace stickslip::drivers {
namespace {

using daq::ReadStatus;

/// Time between deliveries of scans, as with boards that have commands; the ring is sized for it.
constexpr std::int64_t kBundle_ns = 8'000'000;

class PolledBoard final : public daq::Board {
 public:
  PolledBoard(ComediSetup setup, const ComediBoardSettings& settings, base::Clock& clock,
              std::unique_ptr<ComediCalls> calls)
      : setup_(std::move(setup)),
        clock_(clock),
        calls_(std::move(calls)),
        period_ns_(1e9 / setup_.info.scan_rate_granted_Hz),
        continues_(settings.continues) {
    if (setup_.command.second) {
      second_ = setup_.command;
      second_.channel = setup_.command.second->channel;
      second_.range = setup_.command.second->range;
    }
  }

  [[nodiscard]] const daq::BoardInfo& info() const noexcept override { return setup_.info; }

  [[nodiscard]] base::Result<void> start() override {
    if (state_ == State::kAcquiring) return {};
    if (state_ == State::kMissing) return base::failure("{}", last_error());
    // Another owner or a missing board is told now, not at the first scan.
    std::uint32_t code = 0;
    if (const int result = calls_->read_one(setup_.command, code); result < 0) {
      static_cast<void>(ended(result));
      return tl::unexpected(comedi_error(setup_.info.device, -result));
    }
    error_ = 0;
    pending_.reset();
    suspended_ns_ = clock_.suspended_ns();
    started_ns_ = clock_.monotonic_ns();
    if (continues_) next_ = daq::first_scan_after(*continues_, started_ns_);
    first_ = next_;
    state_ = State::kAcquiring;
    return {};
  }

  [[nodiscard]] ReadStatus read(daq::ScanBlock& block, std::chrono::milliseconds timeout) noexcept override {
    block.count = 0;
    if (pending_) return *std::exchange(pending_, std::nullopt);
    if (state_ == State::kMissing) return ReadStatus::kBoardMissing;
    const std::int64_t now_ns = clock_.monotonic_ns();
    const std::int64_t deadline_ns = now_ns + std::chrono::nanoseconds(timeout).count();
    if (state_ == State::kIdle) {
      clock_.sleep_until(deadline_ns);
      return ReadStatus::kTimeout;
    }
    if (clock_.suspended_ns() != suspended_ns_) {
      state_ = State::kIdle;
      return ReadStatus::kSuspended;
    }
    // What is long due cannot be read any more: the scan whose time has come is the next one.
    const auto due =
        first_ +
        static_cast<daq::ScanIndex>(std::floor(static_cast<double>(now_ns - started_ns_) / period_ns_)) - 1;
    next_ = std::max(next_, due);
    block.first = next_;
    block.has_second = setup_.command.second.has_value();
    const std::int64_t bundle_end_ns = std::min(deadline_ns, due_ns(next_) + kBundle_ns);
    while (block.count < daq::ScanBlock::kMaxScans && due_ns(next_) <= bundle_end_ns) {
      const bool prompt = clock_.monotonic_ns() <= due_ns(next_);
      clock_.sleep_until(due_ns(next_));
      std::uint32_t code = 0;
      std::uint32_t second_code = 0;
      int result = calls_->read_one(setup_.command, code);
      if (result >= 0 && block.has_second) result = calls_->read_one(second_, second_code);
      if (result < 0) {
        const ReadStatus status = ended(result);
        if (block.count == 0) return status;
        pending_ = status;
        break;
      }
      block.second[block.count] = static_cast<std::int32_t>(second_code);
      block.raw[block.count++] = code;
      block.stamp = {clock_.monotonic_ns(), clock_.realtime_ns(), prompt};
      // Its time is over before it was asked for: the bundle ends, the jump is seen at the next read.
      if (due_ns(++next_) + static_cast<std::int64_t>(period_ns_) < block.stamp.monotonic_ns) break;
    }
    if (block.count > 0) {
      continues_ = daq::Continuation{block.end(),
                                     {block.end() - 1, block.stamp.monotonic_ns, block.stamp.realtime_ns},
                                     setup_.info.scan_rate_granted_Hz};
      return ReadStatus::kScans;
    }
    clock_.sleep_until(deadline_ns);
    return ReadStatus::kTimeout;
  }

  void stop() noexcept override {
    pending_.reset();
    if (state_ == State::kAcquiring) state_ = State::kIdle;
  }

  [[nodiscard]] std::string last_error() const override {
    return error_ == 0 ? std::string{} : explain_comedi_error(setup_.info.device, error_);
  }

 private:
  enum class State { kIdle, kAcquiring, kMissing };

  [[nodiscard]] std::int64_t due_ns(daq::ScanIndex scan) const noexcept {
    return started_ns_ + std::llround(static_cast<double>(scan - first_ + 1) * period_ns_);
  }

  ReadStatus ended(int result) noexcept {
    error_ = -result;
    state_ = error_ == ENODEV ? State::kMissing : State::kIdle;
    return error_ == ENODEV ? ReadStatus::kBoardMissing : ReadStatus::kFailed;
  }

  ComediSetup setup_;
  ComediCommand second_;  ///< To read the second input, if there is one.
  base::Clock& clock_;
  std::unique_ptr<ComediCalls> calls_;
  double period_ns_;
  std::optional<daq::Continuation> continues_;
  State state_ = State::kIdle;
  std::optional<ReadStatus> pending_;  ///< Why the bundle before ended early.
  daq::ScanIndex first_ = 0;           ///< Of this start; due one period after it.
  daq::ScanIndex next_ = 0;
  std::int64_t started_ns_ = 0;
  std::int64_t suspended_ns_ = 0;  ///< At the start.
  int error_ = 0;
};

}  // namespace

std::unique_ptr<daq::Board> make_polled_board(ComediSetup setup, const ComediBoardSettings& settings,
                                              base::Clock& clock, std::unique_ptr<ComediCalls> calls) {
  return std::make_unique<PolledBoard>(std::move(setup), settings, clock, std::move(calls));
}

}  // namespace stickslip::drivers
