#include "drivers/comedi/comedi_board.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <utility>

#include "drivers/comedi/comedi_errors.hpp"
#include "drivers/comedi/comedi_setup.hpp"
#include "drivers/comedi/polled_board.hpp"

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
constexpr std::size_t kLargestScan_bytes = 8;  ///< Two samples of 4.
/// Time and scan periods without a scan after which a board counts as unplugged: some drivers neither deliver
/// nor report an error when their device is removed.
constexpr std::int64_t kLongestSilence_ns = 5'000'000'000;
constexpr std::int64_t kSilentPeriods = 50;
/// The same time for a board that does not wake its reader at each scan: half of its FIFO may have to fill
/// first, which for 8192 samples takes 11.7 s at 350 Hz.
constexpr std::int64_t kLongestSilenceOfAFifo_ns = 30'000'000'000;

class ComediBoard final : public daq::Board {
 public:
  ComediBoard(ComediSetup setup, const ComediBoardSettings& settings, base::Clock& clock,
              std::unique_ptr<ComediCalls> calls)
      : setup_(std::move(setup)),
        buffer_size_(settings.buffer_size),
        continues_(settings.continues),
        clock_(clock),
        calls_(std::move(calls)),
        meter_(setup_.info.scan_rate_granted_Hz) {
    const auto period_ns = static_cast<std::int64_t>(1e9 / setup_.info.scan_rate_granted_Hz);
    probe_ms_ = std::max(kShortestProbe_ms, period_ns * kProbePeriods / kNanosecondsPerMillisecond);
    const bool each_scan = (setup_.command.flags & kWakeEndOfScan) != 0;
    longest_silence_ns_ =
        std::max(each_scan ? kLongestSilence_ns : kLongestSilenceOfAFifo_ns, period_ns * kSilentPeriods);
  }

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
    if (const int result = calls_->command(setup_.command); result < 0) {
      // The file is open, so permission is not what is lacking.
      if (result == -EACCES) {
        error_ = EACCES;
        return tl::unexpected(
            base::Error{base::ErrorKind::kBusy,
                        fmt::format("{}: subdevice {} is locked by another program; stop that program",
                                    setup_.info.device, setup_.command.subdevice)});
      }
      return refused(-result);
    }
    const std::int64_t now_ns = clock_.monotonic_ns();
    if (const auto from = meter_.continuation(); from || continues_) {
      next_ = daq::first_scan_after(from ? *from : *continues_, now_ns);
    }
    meter_.started(next_, now_ns);
    heard_ns_ = now_ns;
    suspended_ns_ = clock_.suspended_ns();
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
      // The kernel resumes the command or not; no scan tells how many were not taken.
      if (clock_.suspended_ns() != suspended_ns_) return suspended();
      // At most what fits the block: the rest stays in the kernel's buffer, which is large.
      const std::size_t wanted = ScanBlock::kMaxScans * scan_size() - left_over_;
      const int result = calls_->read(std::span(bytes_).subspan(left_over_, wanted));
      if (result > 0) {
        if (deliver(static_cast<std::size_t>(result), waited, block)) return ReadStatus::kScans;
        continue;
      }
      if (result != -EAGAIN && result != -EINTR) return ended(result);
      const std::int64_t now_ns = clock_.monotonic_ns();
      if (now_ns - heard_ns_ > longest_silence_ns_) return silent();
      const std::int64_t left_ns = deadline_ns - now_ns;
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
      case kSilent:
        return fmt::format("{}: the board has sent nothing for {:g} s", setup_.info.device,
                           1e-9 * static_cast<double>(longest_silence_ns_));
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
  static constexpr int kSilent = -2;

  /// Turns `fresh_bytes` new bytes into scans. \return false if they do not complete one.
  bool deliver(std::size_t fresh_bytes, bool waited, ScanBlock& block) noexcept {
    const std::size_t bytes = left_over_ + fresh_bytes;
    const std::size_t count = bytes / scan_size();
    const std::size_t channels = setup_.command.channel_count();
    for (std::size_t i = 0; i < count; ++i) block.raw[i] = sample(i * channels);
    block.has_second = setup_.command.second.has_value();
    if (block.has_second) {
      for (std::size_t i = 0; i < count; ++i) {
        block.second[i] = static_cast<std::int32_t>(sample(i * channels + 1));
      }
    }
    left_over_ = bytes % scan_size();
    std::memmove(bytes_.data(), bytes_.data() + count * scan_size(), left_over_);
    if (count == 0) return false;
    block.first = next_;
    block.count = static_cast<std::uint32_t>(count);
    // Only a read that had to wait and got everything tells when its last scan was taken.
    const bool prompt = waited && count < ScanBlock::kMaxScans;
    block.stamp = {clock_.monotonic_ns(), clock_.realtime_ns(), prompt};
    heard_ns_ = block.stamp.monotonic_ns;
    next_ = block.end();
    meter_.observe(block);
    return true;
  }

  /// Bytes; samples of the channels follow each other.
  [[nodiscard]] std::size_t scan_size() const noexcept {
    return setup_.sample_size * setup_.command.channel_count();
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

  ReadStatus suspended() noexcept {
    calls_->cancel(setup_.command.subdevice);
    state_ = State::kIdle;
    return ReadStatus::kSuspended;
  }

  /// Only closing and opening can help, as for a board that was removed.
  ReadStatus silent() noexcept {
    error_ = kSilent;
    calls_->cancel(setup_.command.subdevice);
    state_ = State::kMissing;
    return ReadStatus::kBoardMissing;
  }

  [[nodiscard]] base::Result<void> refused(int error) {
    error_ = error;
    if (error == ENODEV) state_ = State::kMissing;
    return tl::unexpected(comedi_error(setup_.info.device, error));
  }

  ComediSetup setup_;
  unsigned buffer_size_;
  std::optional<daq::Continuation> continues_;
  base::Clock& clock_;
  std::unique_ptr<ComediCalls> calls_;
  daq::RateMeter meter_;
  std::int64_t probe_ms_ = 0;
  std::int64_t longest_silence_ns_ = 0;
  State state_ = State::kIdle;
  daq::ScanIndex next_ = 0;
  std::int64_t suspended_ns_ = 0;  ///< At the start.
  std::int64_t heard_ns_ = 0;      ///< Of the latest scan, or of the start.
  int error_ = 0;
  std::size_t left_over_ = 0;  ///< Bytes of a scan not complete yet: read() is byte-granular.
  std::array<std::byte, ScanBlock::kMaxScans * kLargestScan_bytes> bytes_{};
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
  if (setup->polled) return make_polled_board(std::move(*setup), settings, clock, std::move(calls));
  return std::make_unique<ComediBoard>(std::move(*setup), settings, clock, std::move(calls));
}

}  // namespace stickslip::drivers
