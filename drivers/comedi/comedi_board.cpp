#include "drivers/comedi/comedi_board.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <utility>

#include "drivers/comedi/comedi_setup.hpp"

namespace stickslip::drivers {
namespace {

using daq::ReadStatus;
using daq::ScanBlock;
using std::chrono::milliseconds;

constexpr std::int64_t kNanosecondsPerMillisecond = 1'000'000;
/// A poll() never waits longer than this many scan periods before read() is asked again: a board that was
/// removed wakes no poll(), only read() tells.
constexpr std::int64_t kProbePeriods = 8;
/// … but not shorter than this, so that fast rates do not busy the processor.
constexpr std::int64_t kShortestProbe_ms = 20;
constexpr std::size_t kLargestSample_bytes = 4;

class ComediBoard final : public daq::Board {
 public:
  ComediBoard(ComediSetup setup, unsigned buffer_size, base::Clock& clock, std::unique_ptr<ComediCalls> calls)
      : setup_(std::move(setup)),
        buffer_size_(buffer_size),
        clock_(clock),
        calls_(std::move(calls)),
        period_ns_(1e9 / setup_.info.scan_rate_granted_Hz),
        probe_ms_(std::max(kShortestProbe_ms, static_cast<std::int64_t>(period_ns_) * kProbePeriods /
                                                  kNanosecondsPerMillisecond)) {}

  ComediBoard(const ComediBoard&) = delete;
  ComediBoard& operator=(const ComediBoard&) = delete;
  ~ComediBoard() override { ComediBoard::stop(); }

  [[nodiscard]] const daq::BoardInfo& info() const noexcept override { return setup_.info; }

  [[nodiscard]] base::Result<void> start() override {
    if (state_ == State::kAcquiring) return {};
    if (state_ == State::kMissing) return refused(ENODEV);
    // Needed after an error that left the subdevice busy, harmless otherwise.
    calls_->cancel(setup_.command.subdevice);
    // The setting outlives close(), so another program may have changed it.
    if (const int result = calls_->set_buffer_size(setup_.command.subdevice, buffer_size_); result < 0) {
      return refused(-result);
    }
    if (const int result = calls_->command(setup_.command); result < 0) return refused(-result);
    next_ = index_now();
    anchor_ = {next_, clock_.monotonic_ns()};
    left_over_ = 0;
    error_ = 0;
    state_ = State::kAcquiring;
    return {};
  }

  [[nodiscard]] ReadStatus read(ScanBlock& block, milliseconds timeout) noexcept override {
    block.count = 0;
    if (state_ == State::kMissing) return ReadStatus::kBoardMissing;
    const std::int64_t deadline_ns = clock_.monotonic_ns() + timeout.count() * kNanosecondsPerMillisecond;
    if (state_ == State::kIdle) {
      clock_.sleep_until(deadline_ns);
      return ReadStatus::kTimeout;
    }
    for (bool waited = false;;) {
      // At most what fits the block: the rest stays in the kernel's buffer, which is large.
      const std::size_t wanted = ScanBlock::kMaxScans * setup_.sample_size - left_over_;
      const int result = calls_->read(std::span(bytes_).subspan(left_over_, wanted));
      if (result > 0) {
        if (deliver(static_cast<std::size_t>(result), waited, block)) return ReadStatus::kScans;
        continue;
      }
      if (result != -EAGAIN && result != -EINTR) return ended(result);
      const std::int64_t left_ns = deadline_ns - clock_.monotonic_ns();
      if (left_ns <= 0) return ReadStatus::kTimeout;
      const std::int64_t left_ms = (left_ns + kNanosecondsPerMillisecond - 1) / kNanosecondsPerMillisecond;
      const int polled = calls_->poll(milliseconds(std::min(left_ms, probe_ms_)));
      if (polled < 0 && polled != -EINTR) return ended(polled);
      waited = true;
    }
  }

  void stop() noexcept override {
    if (state_ != State::kMissing) {
      calls_->cancel(setup_.command.subdevice);
      state_ = State::kIdle;
    }
  }

  [[nodiscard]] std::string last_error() const override {
    switch (error_) {
      case 0:
        return {};
      case EPIPE:
        return fmt::format("{}: the board's buffer overflowed and it halted", setup_.info.device);
      case kEndedByItself:
      case EINVAL:
        return fmt::format("{}: the acquisition was ended by something else than this program",
                           setup_.info.device);
      default:
        return explain_comedi_error(setup_.info.device, error_);
    }
  }

 private:
  enum class State { kIdle, kAcquiring, kMissing };
  static constexpr int kEndedByItself = -1;

  /// A scan that was about to be taken at a known time.
  struct Anchor {
    daq::ScanIndex index = 0;
    std::int64_t monotonic_ns = 0;
  };

  /// What index the next scan has after a restart: the kernel does not know how many went by, the clock
  /// does, to within the latency of the read that set the anchor.
  [[nodiscard]] daq::ScanIndex index_now() const {
    if (!anchor_) return 0;
    const auto elapsed_ns = static_cast<double>(clock_.monotonic_ns() - anchor_->monotonic_ns);
    return std::max(next_,
                    anchor_->index + static_cast<daq::ScanIndex>(std::llround(elapsed_ns / period_ns_)));
  }

  /// Turns `fresh_bytes` new bytes into scans. \return false if they do not complete one.
  bool deliver(std::size_t fresh_bytes, bool waited, ScanBlock& block) noexcept {
    const std::size_t bytes = left_over_ + fresh_bytes;
    const std::size_t count = bytes / setup_.sample_size;
    for (std::size_t i = 0; i < count; ++i) block.raw[i] = sample(i);
    left_over_ = bytes % setup_.sample_size;
    std::memmove(bytes_.data(), bytes_.data() + count * setup_.sample_size, left_over_);
    if (count == 0) return false;
    block.first = next_;
    block.count = static_cast<std::uint32_t>(count);
    block.stamp = {clock_.monotonic_ns(), clock_.realtime_ns()};
    next_ = block.end();
    // Only a read that had to wait and got everything tells when its last scan was taken.
    if (waited && count < ScanBlock::kMaxScans) anchor_ = {next_, block.stamp.monotonic_ns};
    return true;
  }

  [[nodiscard]] double sample(std::size_t i) const noexcept {
    if (setup_.sample_size == sizeof(std::uint32_t)) return load<std::uint32_t>(i);
    return load<std::uint16_t>(i);
  }

  template <typename Sample>
  [[nodiscard]] double load(std::size_t i) const noexcept {
    Sample value{};
    std::memcpy(&value, bytes_.data() + i * sizeof(Sample), sizeof(Sample));
    return value;
  }

  /// \param result of read() or poll(): 0 or −errno.
  ReadStatus ended(int result) noexcept {
    error_ = result == 0 ? kEndedByItself : -result;
    if (error_ == ENODEV) {
      state_ = State::kMissing;
      return ReadStatus::kBoardMissing;
    }
    state_ = State::kIdle;
    return error_ == EPIPE ? ReadStatus::kOverrun : ReadStatus::kFailed;
  }

  [[nodiscard]] base::Result<void> refused(int error) {
    error_ = error;
    if (error == ENODEV) state_ = State::kMissing;
    return base::failure("{}", explain_comedi_error(setup_.info.device, error));
  }

  ComediSetup setup_;
  unsigned buffer_size_;
  base::Clock& clock_;
  std::unique_ptr<ComediCalls> calls_;
  double period_ns_;
  std::int64_t probe_ms_;
  State state_ = State::kIdle;
  daq::ScanIndex next_ = 0;
  std::optional<Anchor> anchor_;
  int error_ = 0;
  std::size_t left_over_ = 0;  ///< Bytes of a sample not complete yet: read() is byte-granular.
  std::array<std::byte, ScanBlock::kMaxScans * kLargestSample_bytes> bytes_{};
};

}  // namespace

base::Result<std::unique_ptr<daq::Board>> make_comedi_board(const ComediBoardSettings& settings,
                                                            base::Clock& clock) {
  return make_comedi_board(settings, clock, make_comedi_calls());
}

base::Result<std::unique_ptr<daq::Board>> make_comedi_board(const ComediBoardSettings& settings,
                                                            base::Clock& clock,
                                                            std::unique_ptr<ComediCalls> calls) {
  auto setup = agree_with_board(settings, *calls);
  if (!setup) return tl::unexpected(setup.error());
  return std::make_unique<ComediBoard>(std::move(*setup), settings.buffer_size, clock, std::move(calls));
}

}  // namespace stickslip::drivers
