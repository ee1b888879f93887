#include "drivers/comedi/comedi_setup.hpp"

#include <fmt/format.h>

#include <cstdint>
#include <limits>
#include <optional>
#include <utility>

#include "drivers/comedi/board_search.hpp"
#include "drivers/comedi/comedi_agreement.hpp"
#include "drivers/comedi/comedi_errors.hpp"

namespace stickslip::drivers {
namespace {

using base::Result;

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

/// One of the inputs, as asked for.
struct Wanted {
  unsigned channel = 0;
  double range_min_V = 0.0;
  double range_max_V = 0.0;
};

/// The narrowest span in volts that holds the voltages asked for.
Result<unsigned> choose_range(const std::string& device, const Wanted& wanted, unsigned subdevice,
                              ComediCalls& calls) {
  const int count = calls.range_count(subdevice, wanted.channel);
  std::optional<unsigned> best;
  double best_width = std::numeric_limits<double>::infinity();
  std::string offered;
  for (unsigned i = 0; count > 0 && i < static_cast<unsigned>(count); ++i) {
    const auto range = calls.range(subdevice, wanted.channel, i);
    if (!range || !range->in_volts) continue;
    offered += fmt::format("{}{:g} … {:g} V", offered.empty() ? "" : ", ", range->min, range->max);
    const double width = range->max - range->min;
    if (range->min <= wanted.range_min_V && range->max >= wanted.range_max_V && width < best_width) {
      best = i;
      best_width = width;
    }
  }
  if (best) return *best;
  return base::usage_error("{}: no range of the board holds {:g} … {:g} V; it offers: {}", device,
                           wanted.range_min_V, wanted.range_max_V,
                           offered.empty() ? "none in volts" : offered);
}

struct Conversion {
  ConversionPolynomial polynomial;
  const char* source = "";
};

/// The range spread over the codes evenly: what a board without any calibration promises.
Conversion uncalibrated(const InputRange& span, std::uint32_t maxdata) {
  return {{{span.min, (span.max - span.min) / maxdata}, 0.0}, "none"};
}

Result<Conversion> conversion(const ComediBoardSettings& settings, unsigned channel, unsigned subdevice,
                              unsigned flags, unsigned range, const InputRange& span, ComediCalls& calls) {
  const bool by_flag = settings.calibration == CalibrationSource::kByFlag;
  if (settings.calibration == CalibrationSource::kNone)
    return uncalibrated(span, calls.maxdata(subdevice, channel));
  if (settings.calibration == CalibrationSource::kSoft ||
      (by_flag && (flags & subdevice_flag::kSoftCalibrated) != 0)) {
    auto soft = calls.soft_calibration(subdevice, channel, range);
    if (!soft) return base::failure("{}: calibration: {}", settings.device, soft.error().message);
    return Conversion{*std::move(soft), "soft"};
  }
  if (auto hard = calls.hard_calibration(subdevice, channel, range))
    return Conversion{*std::move(hard), "hard"};
  if (by_flag) return uncalibrated(span, calls.maxdata(subdevice, channel));
  return base::failure(
      "{}: the board names no conversion to volts for channel {}, range {}; calibration = \"none\" "
      "takes the range as it is",
      settings.device, channel, range);
}

/// An input with all that the board says of it.
struct Input {
  unsigned range = 0;
  InputRange span;
  Conversion conversion;
};

Result<Input> agree_on_input(const ComediBoardSettings& settings, const Wanted& wanted, unsigned subdevice,
                             unsigned flags, int channels, ComediCalls& calls) {
  if (wanted.channel >= static_cast<unsigned>(channels)) {
    return base::usage_error("{}: channel {}; subdevice {} has channels 0 … {}", settings.device,
                             wanted.channel, subdevice, channels - 1);
  }
  const auto range = choose_range(settings.device, wanted, subdevice, calls);
  if (!range) return tl::unexpected(range.error());
  Input input;
  input.range = *range;
  input.span = calls.range(subdevice, wanted.channel, *range).value_or(InputRange{});
  auto converted = conversion(settings, wanted.channel, subdevice, flags, *range, input.span, calls);
  if (!converted) return tl::unexpected(converted.error());
  input.conversion = *std::move(converted);
  return input;
}

Result<daq::SecondChannel> second_channel(const ComediBoardSettings& settings,
                                          const SecondInputSettings& wanted, const Input& input,
                                          std::uint32_t maxdata) {
  if (wanted.channel == settings.channel) {
    return base::usage_error("{}: channel {} is that of the force; the second channel is another one",
                             settings.device, wanted.channel);
  }
  if (maxdata > static_cast<std::uint32_t>(std::numeric_limits<std::int32_t>::max())) {
    return base::usage_error("{}: channel {} has codes up to {}; a second channel may have 2^31 - 1 at most",
                             settings.device, wanted.channel, maxdata);
  }
  daq::SecondChannel channel;
  channel.quantity = wanted.quantity;
  channel.channel = static_cast<int>(wanted.channel);
  channel.maxdata = maxdata;
  channel.range_min_V = input.span.min;
  channel.range_max_V = input.span.max;
  channel.polynomial = input.conversion.polynomial.coefficients;
  channel.expansion_origin = input.conversion.polynomial.expansion_origin;
  channel.calibration = input.conversion.source;
  channel.gain_per_V = wanted.gain_per_V;
  channel.zero_V = wanted.zero_V;
  return channel;
}

}  // namespace

base::Result<ComediSetup> agree_with_board(const ComediBoardSettings& asked, ComediCalls& calls) {
  const base::Result<std::string> device = open_chosen(asked, calls);
  if (!device) return tl::unexpected(device.error());
  ComediBoardSettings settings = asked;
  settings.device = *device;
  const auto failed = [&](int result) { return tl::unexpected(comedi_error(*device, -result)); };

  unsigned subdevice = settings.subdevice.value_or(0);
  if (!settings.subdevice) {
    const int found = calls.find_analog_input();
    if (found < 0) return base::usage_error("{}: the board has no analog input", settings.device);
    subdevice = static_cast<unsigned>(found);
  }
  const unsigned flags = calls.subdevice_flags(subdevice);
  const bool can_command = (flags & subdevice_flag::kCanCommand) != 0;
  if ((flags & subdevice_flag::kReadable) == 0) {
    return base::usage_error("{}: subdevice {} is no analog input that can be read", settings.device,
                             subdevice);
  }
  if (!can_command && settings.acquisition == AcquisitionMode::kCommand) {
    return base::usage_error(
        "{}: subdevice {} cannot acquire by itself (no streaming analog input); acquisition = \"polled\" "
        "reads it "
        "one scan at a time, timed by this computer",
        settings.device, subdevice);
  }
  const int channels = calls.channel_count(subdevice);
  if (channels < 0) return failed(channels);
  if (auto checked = check_reference(settings, flags); !checked) return tl::unexpected(checked.error());
  ComediSetup setup;
  const auto force = agree_on_input(settings, {settings.channel, settings.range_min_V, settings.range_max_V},
                                    subdevice, flags, channels, calls);
  if (!force) return tl::unexpected(force.error());
  std::optional<ComediInput> second;
  if (const auto& wanted = settings.second) {
    const auto input = agree_on_input(settings, {wanted->channel, wanted->range_min_V, wanted->range_max_V},
                                      subdevice, flags, channels, calls);
    if (!input) return tl::unexpected(input.error());
    auto channel = second_channel(settings, *wanted, *input, calls.maxdata(subdevice, wanted->channel));
    if (!channel) return tl::unexpected(channel.error());
    setup.info.second = *std::move(channel);
    second = ComediInput{wanted->channel, input->range};
  }
  const bool polled = settings.acquisition == AcquisitionMode::kPolled || !can_command;
  const auto agreed = polled ? agree_on_polling(settings, subdevice, force->range, second)
                             : agree_on_command(settings, subdevice, force->range, calls, second);
  if (!agreed) return tl::unexpected(agreed.error());

  setup.command = agreed->command;
  setup.polled = polled;
  setup.sample_size = (flags & subdevice_flag::kLargeSample) != 0 ? 4 : 2;
  setup.info.driver = "comedi";
  const BoardIdentity identity{calls.board_name(), calls.driver_name(), calls.place(*device)};
  setup.info.board_name = full_name(identity);
  setup.info.serial = identity.place.serial;
  setup.info.bus_path = identity.place.bus_path;
  setup.info.device = *device;
  setup.info.subdevice = static_cast<int>(subdevice);
  setup.info.channel = static_cast<int>(settings.channel);
  setup.info.maxdata = calls.maxdata(subdevice, settings.channel);
  setup.info.range_min_V = force->span.min;
  setup.info.range_max_V = force->span.max;
  setup.info.polynomial = force->conversion.polynomial.coefficients;
  setup.info.expansion_origin = force->conversion.polynomial.expansion_origin;
  setup.info.scan_rate_requested_Hz = settings.scan_rate_Hz;
  setup.info.scan_rate_granted_Hz = agreed->scan_rate_Hz;
  setup.info.calibration = force->conversion.source;
  setup.info.acquisition = polled ? "polled" : "command";
  setup.info.notes = agreed->notes;
  return setup;
}

}  // namespace stickslip::drivers
