#include "drivers/comedi/comedi_setup.hpp"

#include <fmt/format.h>

#include <cstdint>
#include <limits>
#include <optional>
#include <utility>

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

struct Conversion {
  ConversionPolynomial polynomial;
  const char* source = "";
};

/// The range spread over the codes evenly: what a board without any calibration promises.
Conversion uncalibrated(const InputRange& span, std::uint32_t maxdata) {
  return {{{span.min, (span.max - span.min) / maxdata}, 0.0}, "none"};
}

Result<Conversion> conversion(const ComediBoardSettings& settings, unsigned subdevice, unsigned flags,
                              unsigned range, const InputRange& span, ComediCalls& calls) {
  const bool by_flag = settings.calibration == CalibrationSource::kByFlag;
  if (settings.calibration == CalibrationSource::kNone)
    return uncalibrated(span, calls.maxdata(subdevice, settings.channel));
  if (settings.calibration == CalibrationSource::kSoft ||
      (by_flag && (flags & subdevice_flag::kSoftCalibrated) != 0)) {
    auto soft = calls.soft_calibration(subdevice, settings.channel, range);
    if (!soft) return base::failure("{}: calibration: {}", settings.device, soft.error().message);
    return Conversion{*std::move(soft), "soft"};
  }
  if (auto hard = calls.hard_calibration(subdevice, settings.channel, range))
    return Conversion{*std::move(hard), "hard"};
  if (by_flag) return uncalibrated(span, calls.maxdata(subdevice, settings.channel));
  return base::failure(
      "{}: the board names no conversion to volts for channel {}, range {}; calibration = \"none\" "
      "takes the range as it is",
      settings.device, settings.channel, range);
}

}  // namespace

base::Result<ComediSetup> agree_with_board(const ComediBoardSettings& settings, ComediCalls& calls) {
  const auto failed = [&](int result) { return tl::unexpected(comedi_error(settings.device, -result)); };
  if (const int result = calls.open(settings.device); result < 0) return failed(result);

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
  if (settings.channel >= static_cast<unsigned>(channels)) {
    return base::usage_error("{}: channel {}; subdevice {} has channels 0 … {}", settings.device,
                             settings.channel, subdevice, channels - 1);
  }
  if (auto checked = check_reference(settings, flags); !checked) return tl::unexpected(checked.error());
  const auto range = choose_range(settings, subdevice, calls);
  if (!range) return tl::unexpected(range.error());
  const auto span = calls.range(subdevice, settings.channel, *range).value_or(InputRange{});
  const auto converted = conversion(settings, subdevice, flags, *range, span, calls);
  if (!converted) return tl::unexpected(converted.error());
  const bool polled = settings.acquisition == AcquisitionMode::kPolled || !can_command;
  const auto agreed = polled ? agree_on_polling(settings, subdevice, *range)
                             : agree_on_command(settings, subdevice, *range, calls);
  if (!agreed) return tl::unexpected(agreed.error());

  ComediSetup setup;
  setup.command = agreed->command;
  setup.polled = polled;
  setup.sample_size = (flags & subdevice_flag::kLargeSample) != 0 ? 4 : 2;
  setup.info.driver = "comedi";
  setup.info.board_name = fmt::format("{} ({})", calls.board_name(), calls.driver_name());
  setup.info.device = settings.device;
  setup.info.subdevice = static_cast<int>(subdevice);
  setup.info.channel = static_cast<int>(settings.channel);
  setup.info.maxdata = calls.maxdata(subdevice, settings.channel);
  setup.info.range_min_V = span.min;
  setup.info.range_max_V = span.max;
  setup.info.polynomial = converted->polynomial.coefficients;
  setup.info.expansion_origin = converted->polynomial.expansion_origin;
  setup.info.scan_rate_requested_Hz = settings.scan_rate_Hz;
  setup.info.scan_rate_granted_Hz = agreed->scan_rate_Hz;
  setup.info.calibration = converted->source;
  setup.info.acquisition = polled ? "polled" : "command";
  setup.info.notes = agreed->notes;
  return setup;
}

}  // namespace stickslip::drivers
