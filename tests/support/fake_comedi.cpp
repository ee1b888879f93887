#include "tests/support/fake_comedi.hpp"

#include <algorithm>
#include <cerrno>

namespace stickslip::test {

using drivers::ComediCommand;
using drivers::kWakeEndOfScan;
namespace trigger = drivers::trigger;

namespace {
constexpr unsigned kPageSize = 4096;
}  // namespace

std::vector<std::string> FakeComedi::devices() {
  std::vector<std::string> devices;
  for (const auto& [device, board] : world_.boards) devices.push_back(device);
  return devices;
}

drivers::BoardPlace FakeComedi::place(const std::string& device) {
  if (world_.boards.empty()) return {world_.serial, world_.bus_path};
  const auto found = world_.boards.find(device);
  return found == world_.boards.end() ? drivers::BoardPlace{} : found->second.place;
}

int FakeComedi::open(const std::string& device) {
  if (!world_.boards.empty()) {
    const auto found = world_.boards.find(device);
    if (found == world_.boards.end()) return -ENOENT;
    board_ = found->second;
    return -board_.open_error;
  }
  if (world_.open_error != 0) return -world_.open_error;
  return world_.removed ? -ENODEV : 0;
}

int FakeComedi::channel_count(unsigned subdevice) { return subdevice == 0 ? kChannelCount : -ENODEV; }

std::uint32_t FakeComedi::maxdata(unsigned /*subdevice*/, unsigned /*channel*/) { return world_.maxdata; }

int FakeComedi::range_count(unsigned /*subdevice*/, unsigned /*channel*/) {
  return static_cast<int>(world_.ranges.size());
}

std::optional<drivers::InputRange> FakeComedi::range(unsigned /*subdevice*/, unsigned /*channel*/,
                                                     unsigned range) {
  if (range >= world_.ranges.size()) return std::nullopt;
  return world_.ranges[range];
}

std::optional<drivers::ConversionPolynomial> FakeComedi::hard_calibration(unsigned /*subdevice*/,
                                                                          unsigned /*channel*/,
                                                                          unsigned range) {
  if (!world_.has_hard_calibration) return std::nullopt;
  const auto& span = world_.ranges.at(range);
  return drivers::ConversionPolynomial{{span.min, (span.max - span.min) / world_.maxdata}, 0.0};
}

base::Result<drivers::ConversionPolynomial> FakeComedi::soft_calibration(unsigned /*subdevice*/,
                                                                         unsigned /*channel*/,
                                                                         unsigned /*range*/) {
  if (!world_.soft_calibration) return base::failure("/var/lib/comedi/calibrations/fake: missing");
  return *world_.soft_calibration;
}

int FakeComedi::stage_of(ComediCommand& command) const {
  // 1: unsupported source, zeroed.
  const bool scan_timer = command.scan_begin_source == trigger::kTimer;
  if (scan_timer && !world_.has_scan_timer) {
    command.scan_begin_source = 0;
    return 1;
  }
  if (command.convert_source == trigger::kNow && !world_.has_convert_now) {
    command.convert_source = 0;
    return 1;
  }
  // 2: conflicting sources, unchanged.
  if ((command.flags & kWakeEndOfScan) != 0 && !world_.takes_wake_end_of_scan) return 2;
  // 3: argument out of range, clamped.
  const ComediCommand asked = command;
  const auto clamp = [this](unsigned source, unsigned& argument) {
    argument = source == trigger::kTimer ? std::max(argument, world_.shortest_period_ns) : 0;
  };
  clamp(command.scan_begin_source, command.scan_begin_argument);
  clamp(command.convert_source, command.convert_argument);
  command.scan_end_argument = command.channel_count();
  // All conversions of a scan must fit into it.
  if (command.scan_begin_source == trigger::kTimer && command.convert_source == trigger::kTimer) {
    command.scan_begin_argument =
        std::max(command.scan_begin_argument, command.convert_argument * command.channel_count());
  }
  if (!(command == asked)) return 3;
  // 4: rounded to nearest.
  const auto round = [this](unsigned source, unsigned& argument) {
    if (source != trigger::kTimer) return;
    argument = (argument + world_.rounding_ns / 2) / world_.rounding_ns * world_.rounding_ns;
  };
  round(command.scan_begin_source, command.scan_begin_argument);
  round(command.convert_source, command.convert_argument);
  return command == asked ? 0 : 4;
}

int FakeComedi::command_test(ComediCommand& command) {
  if (world_.removed || command.subdevice != 0) return -ENODEV;
  if (command.channel >= kChannelCount || command.range >= world_.ranges.size()) return -EINVAL;
  if (command.second &&
      (command.second->channel >= kChannelCount || command.second->range >= world_.ranges.size())) {
    return -EINVAL;
  }
  world_.tested.push_back(command);
  return stage_of(command);
}

int FakeComedi::command(const ComediCommand& command) {
  if (world_.removed) return -ENODEV;
  if (world_.locked_by_another) return -EACCES;
  if (world_.used_by_another || running_) return -EBUSY;
  ComediCommand copy = command;
  if (stage_of(copy) != 0) return -EAGAIN;
  if ((command.flags & kPriority) != 0) return -EPERM;
  command_ = command;
  running_ = true;
  overrun_ = false;
  ended_ = false;
  began_ns_ = clock_.monotonic_ns();
  taken_bytes_ = 0;
  read_bytes_ = 0;
  ++world_.command_count;
  return 0;
}

int FakeComedi::cancel(unsigned /*subdevice*/) noexcept {
  if (world_.removed) return -ENODEV;
  if (world_.used_by_another) return -EBUSY;
  running_ = false;
  return 0;
}

int FakeComedi::set_buffer_size(unsigned /*subdevice*/, unsigned size) {
  if (world_.removed) return -ENODEV;
  if (world_.used_by_another || running_) return -EBUSY;
  world_.buffer_size = (size + kPageSize - 1) / kPageSize * kPageSize;
  return static_cast<int>(world_.buffer_size);
}

std::int64_t FakeComedi::sample_size() const {
  return (world_.flags & drivers::subdevice_flag::kLargeSample) != 0 ? 4 : 2;
}

std::int64_t FakeComedi::scan_size() const { return sample_size() * command_.channel_count(); }

std::int64_t FakeComedi::period_ns() const {
  return command_.scan_begin_source == trigger::kTimer
             ? command_.scan_begin_argument
             : static_cast<std::int64_t>(command_.convert_argument) * command_.channel_count();
}

void FakeComedi::run_board() noexcept {
  if (overrun_) return;
  // The timer wakes now and then and hands over all scans that fell due; the first is due one period
  // after the command.
  const std::int64_t interval_ns = world_.wake_interval.count();
  const std::int64_t last_wake_ns = (clock_.monotonic_ns() - began_ns_) / interval_ns * interval_ns;
  const double period_ns = static_cast<double>(this->period_ns()) * (1.0 + world_.clock_error);
  const auto taken = static_cast<std::int64_t>(static_cast<double>(last_wake_ns) / period_ns);
  taken_bytes_ = taken * scan_size();
  if (world_.ends_after_scans >= 0 && taken >= world_.ends_after_scans) {
    taken_bytes_ = world_.ends_after_scans * scan_size();
    ended_ = true;
    return;
  }
  if (world_.removed_at_scan >= 0 && taken >= world_.removed_at_scan) {
    world_.removed = true;
    return;
  }
  if (world_.suspended_at_scan >= 0 && taken >= world_.suspended_at_scan) {
    taken_bytes_ = std::max(read_bytes_, world_.suspended_at_scan * scan_size());
    world_.suspended_at_scan = -1;
    clock_.suspend(world_.suspended);
    return;
  }
  if (world_.overrun_at_scan >= 0 && taken >= world_.overrun_at_scan) {
    taken_bytes_ = std::max(read_bytes_, world_.overrun_at_scan * scan_size());
    world_.overrun_at_scan = -1;
    overrun_ = true;
    clock_.advance(world_.halt);
    return;
  }
  if (taken_bytes_ - read_bytes_ > static_cast<std::int64_t>(world_.buffer_size)) {
    taken_bytes_ = read_bytes_ + static_cast<std::int64_t>(world_.buffer_size);
    overrun_ = true;
  }
}

int FakeComedi::poll(std::chrono::milliseconds timeout) noexcept {
  world_.longest_poll = std::max(world_.longest_poll, timeout);
  const std::int64_t deadline_ns = clock_.monotonic_ns() + std::chrono::nanoseconds(timeout).count();
  // Nobody tells a poller that the board went.
  if (world_.removed) {
    clock_.sleep_until(deadline_ns);
    return 0;
  }
  // Without a command poll() says readable, and read() then EINVAL.
  if (!running_ || world_.cancelled_by_another) return 1;
  for (;;) {
    run_board();
    if (world_.removed) {
      clock_.sleep_until(deadline_ns);
      return 0;
    }
    if (taken_bytes_ > read_bytes_ || overrun_ || ended_) return 1;
    const std::int64_t now_ns = clock_.monotonic_ns();
    if (now_ns >= deadline_ns) return 0;
    const std::int64_t interval_ns = world_.wake_interval.count();
    const std::int64_t next_wake_ns = began_ns_ + ((now_ns - began_ns_) / interval_ns + 1) * interval_ns;
    clock_.sleep_until(std::min(next_wake_ns, deadline_ns));
  }
}

int FakeComedi::read_one(const ComediCommand& input, std::uint32_t& code) noexcept {
  if (world_.removed) return -ENODEV;
  if (world_.used_by_another || running_) return -EBUSY;
  if (!first_channel_) first_channel_ = input.channel;
  const bool first = input.channel == *first_channel_;
  code = first ? world_.reading(insn_count_++) : world_.second_reading(insn_count_ - 1);
  return 1;
}

int FakeComedi::read(std::span<std::byte> buffer) noexcept {
  if (world_.removed) return -ENODEV;
  if (!running_ || world_.cancelled_by_another) return -EINVAL;
  run_board();
  if (world_.removed) return -ENODEV;
  if (taken_bytes_ == read_bytes_) {
    if (ended_) {
      running_ = false;
      return 0;
    }
    if (!overrun_) return -EAGAIN;
    running_ = false;  // EPIPE is said once; then the subdevice is idle.
    return -EPIPE;
  }
  const auto count = std::min({static_cast<std::int64_t>(buffer.size()), taken_bytes_ - read_bytes_,
                               static_cast<std::int64_t>(world_.largest_read)});
  for (std::int64_t i = 0; i < count; ++i, ++read_bytes_) {
    const std::int64_t scan = read_bytes_ / scan_size();
    const bool first = read_bytes_ % scan_size() < sample_size();
    const std::uint32_t reading = first ? world_.reading(scan) : world_.second_reading(scan);
    const auto byte = static_cast<unsigned>(read_bytes_ % sample_size());
    buffer[static_cast<std::size_t>(i)] = static_cast<std::byte>((reading >> (8U * byte)) & 0xFFU);
  }
  return static_cast<int>(count);
}

}  // namespace stickslip::test
