#include "drivers/simulated/simulated_faults.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <utility>

#include "core/base/contract.hpp"
#include "core/sim/random_stream.hpp"

namespace stickslip::drivers {
namespace {

using daq::ReadStatus;

constexpr daq::ScanIndex kNever = std::numeric_limits<daq::ScanIndex>::max();

class FaultyBoard final : public daq::Board {
 public:
  FaultyBoard(std::unique_ptr<daq::Board> board, const SimulatedFaults& faults)
      : board_(std::move(board)), faults_(faults) {}

  [[nodiscard]] const daq::BoardInfo& info() const noexcept override { return board_->info(); }

  [[nodiscard]] base::Result<void> start() override {
    if (missing_) return base::failure("the simulated board is gone");
    overrun_is_due_ = false;
    return board_->start();
  }

  [[nodiscard]] ReadStatus read(daq::ScanBlock& block, std::chrono::milliseconds timeout) noexcept override {
    block.count = 0;
    if (missing_) return ReadStatus::kBoardMissing;
    if (std::exchange(overrun_is_due_, false)) return ReadStatus::kOverrun;
    if (const ReadStatus status = board_->read(block, timeout); status != ReadStatus::kScans) return status;
    if (!drawn_) draw_first(block.first);
    drop_lost(block);
    if (block.count == 0) return ReadStatus::kTimeout;
    if (block.end() > loss_) {
      cut(block, loss_);
      missing_ = true;
    } else if (block.end() > overrun_) {
      cut(block, overrun_);
      begin_overrun();
    }
    if (block.count > 0) return ReadStatus::kScans;
    if (missing_) return ReadStatus::kBoardMissing;
    overrun_is_due_ = false;
    return ReadStatus::kOverrun;
  }

  void stop() noexcept override {
    overrun_is_due_ = false;
    board_->stop();
  }
  [[nodiscard]] std::string last_error() const override {
    return missing_ ? "the simulated board was pulled out" : board_->last_error();
  }

 private:
  [[nodiscard]] daq::ScanIndex drawn_after(daq::ScanIndex scan, double every_s) noexcept {
    if (every_s <= 0.0) return kNever;
    std::exponential_distribution<double> wait{1.0 / (every_s * info().scan_rate_granted_Hz)};
    return scan + 1 + std::llround(wait(random_));
  }

  void draw_first(daq::ScanIndex scan) noexcept {
    drawn_ = true;
    // Of each board object its own, or what has been pulled out once would be pulled out at once again.
    random_.seed(sim::stream_seed(faults_.seed, static_cast<std::uint64_t>(scan)));
    loss_ = drawn_after(scan, faults_.losses_every_s);
    overrun_ = drawn_after(scan, faults_.overruns_every_s);
  }

  void begin_overrun() noexcept {
    const double longest = std::max(1.0, kLongestOverrun_s * info().scan_rate_granted_Hz);
    std::uniform_int_distribution<daq::ScanIndex> length{1, std::llround(longest)};
    delivered_again_ = overrun_ + length(random_);
    overrun_ = drawn_after(delivered_again_, faults_.overruns_every_s);
    overrun_is_due_ = true;
  }

  /// Takes off the front what an overrun has lost.
  void drop_lost(daq::ScanBlock& block) const noexcept {
    const daq::ScanIndex lost = std::clamp<daq::ScanIndex>(delivered_again_ - block.first, 0, block.count);
    if (lost == 0) return;
    std::copy(block.raw.begin() + lost, block.raw.begin() + block.count, block.raw.begin());
    std::copy(block.second.begin() + lost, block.second.begin() + block.count, block.second.begin());
    block.first += lost;
    block.count -= static_cast<std::uint32_t>(lost);
  }

  static void cut(daq::ScanBlock& block, daq::ScanIndex end) noexcept {
    block.count = static_cast<std::uint32_t>(std::max<daq::ScanIndex>(end - block.first, 0));
  }

  std::unique_ptr<daq::Board> board_;
  SimulatedFaults faults_;
  std::mt19937_64 random_;
  bool drawn_ = false;
  bool missing_ = false;
  bool overrun_is_due_ = false;
  daq::ScanIndex loss_ = kNever;
  daq::ScanIndex overrun_ = kNever;
  daq::ScanIndex delivered_again_ = 0;
};

}  // namespace

std::unique_ptr<daq::Board> with_faults(std::unique_ptr<daq::Board> board, const SimulatedFaults& faults) {
  STICKSLIP_EXPECTS(faults.overruns_every_s >= 0.0 && faults.losses_every_s >= 0.0);
  return std::make_unique<FaultyBoard>(std::move(board), faults);
}

}  // namespace stickslip::drivers
