#include "drivers/comedi/comedi_agreement.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <cmath>
#include <limits>
#include <utility>

#include "drivers/comedi/comedi_errors.hpp"

namespace stickslip::drivers {
namespace {

using base::Result;

/// command_test answers 0 after at most this many rounds on the boards seen (3 → 4 → 0); more means
/// that the board never agrees.
constexpr int kMostTests = 5;
constexpr double kNanosecondsPerSecond = 1e9;
/// Highest rate at which a thread of an ordinary computer can read each scan in time.
constexpr double kFastestPolling_Hz = 2000.0;

/// Nanoseconds between scans, rounded.
Result<unsigned> period_of_rate(const ComediBoardSettings& settings) {
  const double period_ns = std::round(kNanosecondsPerSecond / settings.scan_rate_Hz);
  if (!(settings.scan_rate_Hz > 0.0) || !(period_ns >= 1.0) ||
      period_ns > static_cast<double>(std::numeric_limits<unsigned>::max())) {
    return base::usage_error("{}: scan rate {:g} Hz; allowed are 0.2329 Hz to 1 GHz", settings.device,
                             settings.scan_rate_Hz);
  }
  return static_cast<unsigned>(period_ns);
}

/// What the scans are timed by. Boards differ in what they can do; with one channel the three are the
/// same measurement. With two the second conversion follows the first at once, or as fast as the board can,
/// or half a period later. Listed in order of preference.
enum class Timing {
  kScanTimer,             ///< A timer starts each scan, conversions follow at once.
  kScanAndConvertTimers,  ///< The same on boards whose conversions have a timer of their own.
  kConvertTimer,          ///< Scans follow each other; the conversion timer is the rate.
};

ComediCommand build(Timing timing, unsigned flags, unsigned period_ns, unsigned channels) {
  ComediCommand command;
  command.flags = flags;
  command.start_source = trigger::kNow;
  command.scan_begin_source = timing == Timing::kConvertTimer ? trigger::kFollow : trigger::kTimer;
  command.scan_begin_argument = timing == Timing::kConvertTimer ? 0 : period_ns;
  command.convert_source = timing == Timing::kScanTimer ? trigger::kNow : trigger::kTimer;
  // 0 where the scan timer rules: command_test raises it to the shortest that the board can do.
  command.convert_argument = timing == Timing::kConvertTimer ? period_ns / channels : 0;
  command.scan_end_source = trigger::kCount;
  command.scan_end_argument = channels;
  command.stop_source = trigger::kNone;
  return command;
}

unsigned period_of(const ComediCommand& command) {
  return command.scan_begin_source == trigger::kTimer ? command.scan_begin_argument
                                                      : command.convert_argument * command.channel_count();
}

/// Appends what the board changed, "stage 4: scan_begin_arg 2857143 -> 2857000".
void note_changes(int stage, const ComediCommand& before, const ComediCommand& after, std::string& notes) {
  struct Field {
    const char* name;
    unsigned ComediCommand::*member;
  };
  static constexpr Field kFields[] = {{"flags", &ComediCommand::flags},
                                      {"start_src", &ComediCommand::start_source},
                                      {"start_arg", &ComediCommand::start_argument},
                                      {"scan_begin_src", &ComediCommand::scan_begin_source},
                                      {"scan_begin_arg", &ComediCommand::scan_begin_argument},
                                      {"convert_src", &ComediCommand::convert_source},
                                      {"convert_arg", &ComediCommand::convert_argument},
                                      {"scan_end_src", &ComediCommand::scan_end_source},
                                      {"scan_end_arg", &ComediCommand::scan_end_argument},
                                      {"stop_src", &ComediCommand::stop_source},
                                      {"stop_arg", &ComediCommand::stop_argument}};
  for (const Field& field : kFields) {
    if (before.*field.member == after.*field.member) continue;
    notes += fmt::format("{}stage {}: {} {} -> {}", notes.empty() ? "" : ", ", stage, field.name,
                         before.*field.member, after.*field.member);
  }
}

/// \return 0 and the command as the board takes it; > 0 if it never agrees; −errno.
int test_until_agreed(ComediCommand& command, ComediCalls& calls, std::string& notes) {
  const ComediCommand asked = command;
  int stage = 0;
  for (int test = 0; test < kMostTests; ++test) {
    const ComediCommand before = command;
    stage = calls.command_test(command);
    if (stage <= 0) break;
    note_changes(stage, before, command, notes);
    // Stages 1 and 2 object to a source: repeating does not help.
    if (stage <= 2) return stage;
  }
  const bool same_sources = command.scan_begin_source == asked.scan_begin_source &&
                            command.convert_source == asked.convert_source &&
                            command.stop_source == asked.stop_source &&
                            command.scan_end_argument == asked.scan_end_argument;
  return stage == 0 && !same_sources ? 1 : stage;
}

}  // namespace

Result<Agreement> agree_on_command(const ComediBoardSettings& settings, unsigned subdevice, unsigned range,
                                   ComediCalls& calls, const std::optional<ComediInput>& second) {
  const auto period_ns = period_of_rate(settings);
  if (!period_ns) return tl::unexpected(period_ns.error());
  double nearest_Hz = 0.0;
  for (const Timing timing : {Timing::kScanTimer, Timing::kScanAndConvertTimers, Timing::kConvertTimer}) {
    // Without kWakeEndOfScan some boards hand over half a FIFO at a time: 0.7 s at 350 Hz.
    for (const unsigned flags : {kWakeEndOfScan, 0U}) {
      ComediCommand command = build(timing, flags, *period_ns, second ? 2 : 1);
      command.second = second;
      command.subdevice = subdevice;
      command.channel = settings.channel;
      command.range = range;
      command.reference = settings.reference;
      std::string notes = flags == 0 ? "no wake-up at each scan" : "";
      const int stage = test_until_agreed(command, calls, notes);
      if (stage == -ENODEV || stage == -EACCES || stage == -EPERM) {
        return tl::unexpected(comedi_error(settings.device, -stage));
      }
      if (stage != 0 || period_of(command) == 0) continue;
      const double granted_Hz = kNanosecondsPerSecond / period_of(command);
      const double difference = std::abs(granted_Hz / settings.scan_rate_Hz - 1.0);
      if (difference <= settings.scan_rate_tolerance) return Agreement{command, granted_Hz, std::move(notes)};
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
  return base::failure("{}: the board cannot acquire {} by a timer without end; use another board",
                       settings.device,
                       second ? fmt::format("channels {} and {}", settings.channel, second->channel)
                              : fmt::format("channel {}", settings.channel));
}

Result<Agreement> agree_on_polling(const ComediBoardSettings& settings, unsigned subdevice, unsigned range,
                                   const std::optional<ComediInput>& second) {
  const auto period_ns = period_of_rate(settings);
  if (!period_ns) return tl::unexpected(period_ns.error());
  if (settings.scan_rate_Hz > kFastestPolling_Hz) {
    return base::usage_error(
        "{}: scan rate {:g} Hz; a board that is read one scan at a time can be asked for {:g} Hz "
        "at most",
        settings.device, settings.scan_rate_Hz, kFastestPolling_Hz);
  }
  Agreement agreement;
  agreement.command.subdevice = subdevice;
  agreement.command.channel = settings.channel;
  agreement.command.range = range;
  agreement.command.reference = settings.reference;
  agreement.command.second = second;
  agreement.scan_rate_Hz = kNanosecondsPerSecond / *period_ns;
  agreement.notes = "read one scan at a time, timed by this computer";
  return agreement;
}

}  // namespace stickslip::drivers
