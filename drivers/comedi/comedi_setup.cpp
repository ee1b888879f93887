#include "drivers/comedi/comedi_setup.hpp"

#include <fmt/format.h>

#include <array>
#include <cerrno>
#include <cmath>
#include <limits>
#include <system_error>

namespace stickslip::drivers {
namespace {

using base::Result;

/// command_test answers 0 after at most this many rounds on the boards seen (3 → 4 → 0); more means
/// that the board never agrees.
constexpr int kMostTests = 5;
constexpr double kNanosecondsPerSecond = 1e9;

struct ReferenceName {
  unsigned flag;
  const char* name;
};

ReferenceName describe(AnalogReference reference) {
  switch (reference) {
    case AnalogReference::kGround:
      return {subdevice_flag::kGround, "ground"};
    case AnalogReference::kCommon:
      return {subdevice_flag::kCommon, "common"};
    case AnalogReference::kDifferential:
      return {subdevice_flag::kDifferential, "differential"};
    case AnalogReference::kOther:
      break;
  }
  return {subdevice_flag::kOther, "other"};
}

/// The board accepts any reference without a word, so the flags are asked.
Result<void> check_reference(const ComediBoardSettings& settings, unsigned flags) {
  const ReferenceName wanted = describe(settings.reference);
  if ((flags & wanted.flag) != 0) return {};
  std::string offered;
  for (const auto reference : {AnalogReference::kGround, AnalogReference::kCommon,
                               AnalogReference::kDifferential, AnalogReference::kOther}) {
    const ReferenceName known = describe(reference);
    if ((flags & known.flag) != 0) offered += (offered.empty() ? "" : ", ") + std::string(known.name);
  }
  return base::usage_error("{}: reference \"{}\" is not wired on this board; it offers: {}", settings.device,
                           wanted.name, offered.empty() ? "none" : offered);
}

/// The narrowest span in volts that holds the voltages asked for.
Result<unsigned> choose_range(const ComediBoardSettings& settings, unsigned subdevice, ComediCalls& calls) {
  const int count = calls.range_count(subdevice, settings.channel);
  std::optional<unsigned> best;
  double best_width = std::numeric_limits<double>::infinity();
  std::string offered;
  for (unsigned i = 0; count > 0 && i < static_cast<unsigned>(count); ++i) {
    const auto range = calls.range(subdevice, settings.channel, i);
    if (!range || !range->in_volts) continue;
    offered += fmt::format("{}{:g} … {:g} V", offered.empty() ? "" : ", ", range->min, range->max);
    const double width = range->max - range->min;
    if (range->min <= settings.range_min_V && range->max >= settings.range_max_V && width < best_width) {
      best = i;
      best_width = width;
    }
  }
  if (best) return *best;
  return base::usage_error("{}: no range of the board holds {:g} … {:g} V; it offers: {}", settings.device,
                           settings.range_min_V, settings.range_max_V,
                           offered.empty() ? "none in volts" : offered);
}

/// What the scans are timed by. Boards differ in what they can do; with one channel the three are the
/// same measurement. Listed in order of preference.
enum class Timing {
  kScanTimer,             ///< A timer starts each scan, conversions follow at once.
  kScanAndConvertTimers,  ///< The same on boards whose conversions have a timer of their own.
  kConvertTimer,          ///< Scans follow each other; the conversion timer is the rate.
};

ComediCommand build(Timing timing, unsigned flags, unsigned period_ns) {
  ComediCommand command;
  command.flags = flags;
  command.start_source = trigger::kNow;
  command.scan_begin_source = timing == Timing::kConvertTimer ? trigger::kFollow : trigger::kTimer;
  command.scan_begin_argument = timing == Timing::kConvertTimer ? 0 : period_ns;
  command.convert_source = timing == Timing::kScanTimer ? trigger::kNow : trigger::kTimer;
  // 0 where the scan timer rules: command_test raises it to the shortest that the board can do.
  command.convert_argument = timing == Timing::kConvertTimer ? period_ns : 0;
  command.scan_end_source = trigger::kCount;
  command.scan_end_argument = 1;
  command.stop_source = trigger::kNone;
  return command;
}

unsigned period_of(const ComediCommand& command) {
  return command.scan_begin_source == trigger::kTimer ? command.scan_begin_argument
                                                      : command.convert_argument;
}

/// \return 0 and the command as the board takes it; > 0 if it never agrees; −errno.
int test_until_agreed(ComediCommand& command, ComediCalls& calls) {
  const ComediCommand asked = command;
  int stage = 0;
  for (int test = 0; test < kMostTests; ++test) {
    stage = calls.command_test(command);
    if (stage <= 0) break;
    // Stages 1 and 2 object to a source: repeating does not help.
    if (stage <= 2) return stage;
  }
  const bool same_sources = command.scan_begin_source == asked.scan_begin_source &&
                            command.convert_source == asked.convert_source &&
                            command.stop_source == asked.stop_source &&
                            command.scan_end_argument == asked.scan_end_argument;
  return stage == 0 && !same_sources ? 1 : stage;
}

Result<ComediCommand> agree_on_command(const ComediBoardSettings& settings, unsigned subdevice,
                                       unsigned range, ComediCalls& calls) {
  const double period_ns = std::round(kNanosecondsPerSecond / settings.scan_rate_Hz);
  if (!(settings.scan_rate_Hz > 0.0) || !(period_ns >= 1.0) ||
      period_ns > static_cast<double>(std::numeric_limits<unsigned>::max())) {
    return base::usage_error("{}: scan rate {:g} Hz; allowed are 0.2329 Hz to 1 GHz", settings.device,
                             settings.scan_rate_Hz);
  }
  double nearest_Hz = 0.0;
  for (const Timing timing : {Timing::kScanTimer, Timing::kScanAndConvertTimers, Timing::kConvertTimer}) {
    // Without kWakeEndOfScan some boards hand over half a FIFO at a time: 0.7 s at 350 Hz.
    for (const unsigned flags : {kWakeEndOfScan, 0U}) {
      ComediCommand command = build(timing, flags, static_cast<unsigned>(period_ns));
      command.subdevice = subdevice;
      command.channel = settings.channel;
      command.range = range;
      command.reference = settings.reference;
      const int stage = test_until_agreed(command, calls);
      if (stage == -ENODEV || stage == -EACCES || stage == -EPERM) {
        return base::failure("{}", explain_comedi_error(settings.device, -stage));
      }
      if (stage != 0 || period_of(command) == 0) continue;
      const double granted_Hz = kNanosecondsPerSecond / period_of(command);
      const double difference = std::abs(granted_Hz / settings.scan_rate_Hz - 1.0);
      if (difference <= settings.scan_rate_tolerance) return command;
      if (nearest_Hz == 0.0 || difference < std::abs(nearest_Hz / settings.scan_rate_Hz - 1.0)) {
        nearest_Hz = granted_Hz;
      }
    }
  }
  if (nearest_Hz > 0.0) {
    return base::usage_error(
        "{}: scan rate {:g} Hz; the nearest that the board grants is {:.9g} Hz, farther than the {:g} % "
        "allowed; "
        "ask for a rate that it has",
        settings.device, settings.scan_rate_Hz, nearest_Hz, 100.0 * settings.scan_rate_tolerance);
  }
  return base::failure("{}: the board cannot acquire channel {} by a timer without end; use another board",
                       settings.device, settings.channel);
}

Result<ConversionPolynomial> conversion(const ComediBoardSettings& settings, unsigned subdevice,
                                        unsigned flags, unsigned range, ComediCalls& calls) {
  if ((flags & subdevice_flag::kSoftCalibrated) != 0) {
    auto soft = calls.soft_calibration(subdevice, settings.channel, range);
    if (!soft) return base::failure("{}: calibration: {}", settings.device, soft.error().message);
    return soft;
  }
  auto hard = calls.hard_calibration(subdevice, settings.channel, range);
  if (!hard) {
    return base::failure("{}: the board names no conversion to volts for channel {}, range {}",
                         settings.device, settings.channel, range);
  }
  return *hard;
}

}  // namespace

std::string explain_comedi_error(const std::string& device, int error) {
  switch (error) {
    case EBUSY:
      return fmt::format(
          "{}: another program is using it; stop that program (\"fuser -v {}\" names it) and try again",
          device, device);
    case EACCES:
    case EPERM:
      return fmt::format(
          "{}: permission denied; add the user to group iocard (\"sudo adduser USER iocard\") and log in "
          "again",
          device);
    case ENOENT:
      return fmt::format(
          "{}: no such device; plug the board in or load its driver (\"cat /proc/comedi\" lists boards)",
          device);
    case ENODEV:
    case ENXIO:
      return fmt::format(
          "{}: no board behind this device; plug it in or configure it (\"cat /proc/comedi\" lists "
          "boards)",
          device);
    default:
      return fmt::format("{}: {}", device, std::generic_category().message(error));
  }
}

base::Result<ComediSetup> agree_with_board(const ComediBoardSettings& settings, ComediCalls& calls) {
  const auto failed = [&](int result) {
    return base::failure("{}", explain_comedi_error(settings.device, -result));
  };
  if (const int result = calls.open(settings.device); result < 0) return failed(result);

  unsigned subdevice = settings.subdevice.value_or(0);
  if (!settings.subdevice) {
    const int found = calls.find_analog_input();
    if (found < 0) return base::usage_error("{}: the board has no analog input", settings.device);
    subdevice = static_cast<unsigned>(found);
  }
  const unsigned flags = calls.subdevice_flags(subdevice);
  if ((flags & subdevice_flag::kCanCommand) == 0) {
    return base::usage_error("{}: subdevice {} cannot acquire by itself (no streaming analog input)",
                             settings.device, subdevice);
  }
  const int channels = calls.channel_count(subdevice);
  if (channels < 0) return failed(channels);
  if (settings.channel >= static_cast<unsigned>(channels)) {
    return base::usage_error("{}: channel {}; subdevice {} has channels 0 … {}", settings.device,
                             settings.channel, subdevice, channels - 1);
  }
  if (auto checked = check_reference(settings, flags); !checked) return tl::unexpected(checked.error());
  const auto range = choose_range(settings, subdevice, calls);
  if (!range) return tl::unexpected(range.error());
  const auto polynomial = conversion(settings, subdevice, flags, *range, calls);
  if (!polynomial) return tl::unexpected(polynomial.error());
  const auto command = agree_on_command(settings, subdevice, *range, calls);
  if (!command) return tl::unexpected(command.error());

  const auto span = calls.range(subdevice, settings.channel, *range);
  ComediSetup setup;
  setup.command = *command;
  setup.sample_size = (flags & subdevice_flag::kLargeSample) != 0 ? 4 : 2;
  setup.info.driver = "comedi";
  setup.info.board_name = fmt::format("{} ({})", calls.board_name(), calls.driver_name());
  setup.info.device = settings.device;
  setup.info.subdevice = static_cast<int>(subdevice);
  setup.info.channel = static_cast<int>(settings.channel);
  setup.info.maxdata = calls.maxdata(subdevice, settings.channel);
  setup.info.range_min_V = span ? span->min : 0.0;
  setup.info.range_max_V = span ? span->max : 0.0;
  setup.info.polynomial = polynomial->coefficients;
  setup.info.expansion_origin = polynomial->expansion_origin;
  setup.info.scan_rate_requested_Hz = settings.scan_rate_Hz;
  setup.info.scan_rate_granted_Hz = kNanosecondsPerSecond / period_of(*command);
  return setup;
}

}  // namespace stickslip::drivers
