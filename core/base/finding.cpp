#include "core/base/finding.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace stickslip::base {
namespace {

using enum FindingCode;
using enum Severity;

constexpr std::array<FindingKind, kFindingCodes> kKinds{{
    {kNoSelfCheck, "no-self-check", "self-check", kNote,
     "The scans before the test did not suffice to look at the unloaded tester",
     "leave the tester unloaded and still for a second before each test"},
    {kSelfCheckSaturated, "self-check-saturated", "self-check", kFault,
     "The converter was at a rail with no load",
     "check the wiring, the amplifier's zero and the board's range"},
    {kSelfCheckSpikes, "self-check-spikes", "self-check", kWarning,
     "More than 20 spikes a second with no load", "look for a loose contact"},
    {kSelfCheckZero, "self-check-zero", "self-check", kWarning,
     "The unloaded cell read more than 0.0025 of the sled's weight", "tare before the next test"},
    {kSelfCheckDrift, "self-check-drift", "self-check", kWarning,
     "The zero drifted by more than 0.0025 of the sled's weight in a minute", "let the tester warm up"},
    {kSelfCheckNoise, "self-check-noise", "self-check", kWarning,
     "The noise of a scan was more than 0.005 of the sled's weight",
     "shield the cable, and look for what shakes the tester"},
    {kSelfCheckHum, "self-check-hum", "self-check", kWarning,
     "The hum of the mains was more than 0.0025 of the sled's weight", "look for a ground loop"},
    {kSelfCheckRate, "self-check-rate", "self-check", kWarning,
     "The board scanned by more than 0.1 % off the granted rate before the test",
     "measure the board's clock; omega, frequencies and speeds are off by as much"},
    {kScanRate, "scan-rate", "clock", kWarning,
     "The board scanned by more than 100 ppm off the granted rate during the test",
     "multiply omega, frequencies and speeds by the factor"},
    {kFewScans, "few-scans", "clock", kWarning, "A cycle has so few scans that peaks are missed",
     "scan as often as the finding says"},
    {kSaturated, "saturated", "saturation", kWarning, "The converter was at a rail during the test",
     "choose a wider range of the board or amplify less, and test again"},
    {kClipped, "clipped", "signal", kFault,
     "The highest force repeats as noise would not let it: the amplifier clips below the converter's rail",
     "amplify less or take a lighter sled, look at the amplifier's supply and zero, and test again"},
    {kFrozen, "frozen", "signal", kFault,
     "The force under load stood at one value for longer than noise lets it",
     "look at the cable, the amplifier and the board, and test again"},
    {kNoPull, "no-pull", "signal", kFault, "The force jumped or was gone as that of a pulled sled cannot be",
     "look for what switches or touches the cell, and leave the record out"},
    {kHum, "hum", "signal", kWarning,
     "The mains hum by more than 0.0025 in a test without slips, or make its falls",
     "look for a ground loop, and test again: the regime holds for slips that are larger than the hum"},
    {kCoarseSteps, "coarse-steps", "signal", kWarning,
     "The noise of a scan is less than a quarter of a step of the converter",
     "choose a narrower range of the board or amplify more: standard errors do not hold"},
    {kBeginsUnderLoad, "begins-under-load", "signal", kNote,
     "The first scans are in mid-pull: the peak before the first slip is not among them",
     "record from before the pull where the static coefficient is wanted"},
    {kHolds, "holds", "plan", kNote, "The belt stood still while the sled rested, and pulled on",
     "none where the test is one of holds, which stickslip law takes; else look whether the belt stops"},
    {kZeroOffset, "zero-offset", "zero", kWarning,
     "The unloaded cell read more than 0.0025 of the sled's weight before or after the test",
     "tare before the next test"},
    {kPullSpeed, "pull-speed", "plan", kWarning,
     "The measured pull speed is by more than 5 % off the planned one",
     "correct the tester's speed, or pull_speed of the plan"},
    {kFastBelt, "fast-belt", "plan", kWarning,
     "The belt is so fast that the sled need not come to rest on it before the first slip",
     "pull more slowly than K g/omega where S is wanted: K and gamma hold"},
    {kSledMass, "sled-mass", "plan", kFault, "The sled is outside 5 g … 20 kg",
     "correct sled_mass under [tester]: every coefficient is divided by its weight"},
    {kCoefficient, "coefficient", "plan", kFault, "A coefficient is outside 0.01 … 5",
     "check unit and sign of the force, load cell gain and sled mass"},
    {kGainChange, "gain-change", "calibration", kWarning,
     "The calibration changed the gain by more than 20 %, and somebody confirmed it",
     "check the unit of each mass, the amplifier's range and the load cell"},
    {kCalibrationExpired, "calibration-expired", "calibration", kWarning,
     "The calibration of the load cell had expired", "calibrate: stickslip calibrate"},
    {kCalibrationLine, "calibration-line", "calibration", kWarning,
     "The readings of a calibration scatter about a line by more than 0.2 % of the largest change",
     "check each mass, and calibrate again"},
    {kCalibrationHysteresis, "calibration-hysteresis", "calibration", kWarning,
     "Readings under falling load differ by more than 0.2 % from those under rising load",
     "tighten the cell's mounting, and calibrate again"},
    {kRateUnchecked, "rate-unchecked", "import", kNote,
     "The time column of an imported trace is too coarse to check its rate",
     "compare the rate with that of the program that wrote the trace"},
    {kNotFitted, "not-fitted", "misfit", kWarning,
     "No law with a fit describes the test: S and K come from turning points, or have no value",
     "read the reason, and use S - K with the uncertainty given"},
    {kMisfit, "misfit", "misfit", kWarning,
     "The fit leaves residuals larger than the noise, or the same in each slip",
     "look for the cause named; if it is the load cell or a filter, state it (load_cell_frequency, "
     "anti_alias); else use S - K with the uncertainty given"},
    {kTransducerShows, "transducer-shows", "misfit", kWarning,
     "The load cell and filter that are stated are not taken off the trace",
     "check their frequencies; import or record a part of the test; S and K are as read"},
    {kLevelDrift, "level-drift", "consistency", kNote, "S and K drift along the track",
     "look at the cycles: S and K are means over this stretch"},
    {kSlack, "slack", "consistency", kWarning,
     "The coupling hung slack between slips: the force reached that of the unloaded cell",
     "pull more slowly or by a stiffer coupling: only slips without slack tell K"},
    {kTesterChanged, "tester-changed", "consistency", kWarning,
     "Omega and gamma of the test disagree with the characterisation of the tester",
     "characterise the tester again: stickslip characterise"},
    {kRepeatedScans, "repeated-scans", "consistency", kFault, "Two tests of a report have the same scans",
     "leave one of the two out of the report"},
    {kTrendReference, "trend-reference", "trend", kWarning,
     "The reference paper has shifted on its control chart",
     "compare a fresh sheet, then look at the sled and the belt"},
    {kTrendOmega, "trend-omega", "trend", kWarning, "Omega has shifted on its control chart",
     "look at the coupling, the load cell and the sled mass"},
    {kTrendDamping, "trend-damping", "trend", kWarning, "Gamma/2omega has shifted on its control chart",
     "look for what rubs, and at the sheets"},
    {kTrendZero, "trend-zero", "trend", kWarning, "The zero has shifted on its control chart",
     "tare, or calibrate"},
    {kTrendNoise, "trend-noise", "trend", kWarning, "The noise has shifted on its control chart",
     "look at cable, shield and what shakes the tester"},
    {kTrendSpikes, "trend-spikes", "trend", kWarning, "Spikes have shifted on their control chart",
     "look for a loose contact"},
    {kTrendRate, "trend-rate", "trend", kWarning, "The scan rate has shifted on its control chart",
     "compare the computer's clock, then the board's"},
    {kUncoded, "uncoded", "record", kWarning, "A record of before there were codes has this sentence alone",
     "read the sentence"},
}};

constexpr bool in_order() {
  for (std::size_t i = 0; i < kKinds.size(); ++i) {
    if (static_cast<std::size_t>(kKinds[i].code) != i) return false;
  }
  return true;
}
static_assert(in_order());

}  // namespace

std::string_view name(Severity severity) noexcept {
  switch (severity) {
    case kNote:
      return "note";
    case kWarning:
      return "warning";
    case kFault:
      return "fault";
  }
  return "warning";
}

std::optional<Severity> severity_from_name(std::string_view text) noexcept {
  for (const Severity severity : kSeverities) {
    if (name(severity) == text) return severity;
  }
  return std::nullopt;
}

std::span<const FindingKind, kFindingCodes> finding_kinds() noexcept { return kKinds; }

const FindingKind& kind_of(FindingCode code) noexcept { return kKinds[static_cast<std::size_t>(code)]; }

Finding make_finding(FindingCode code, std::string text, std::vector<FindingNumber> numbers) {
  const FindingKind& kind = kind_of(code);
  std::erase_if(numbers, [](const FindingNumber& number) { return !std::isfinite(number.value); });
  return {std::string{kind.name}, kind.severity, std::move(text), std::string{kind.action},
          std::move(numbers)};
}

void add(std::vector<Finding>& list, Finding finding) {
  const auto behind = std::find_if(list.begin(), list.end(),
                                   [&](const Finding& other) { return other.severity < finding.severity; });
  list.insert(behind, std::move(finding));
}

std::vector<std::string> texts_of(std::span<const Finding> findings) {
  std::vector<std::string> texts;
  texts.reserve(findings.size());
  for (const Finding& finding : findings) texts.push_back(finding.text);
  return texts;
}

}  // namespace stickslip::base
