/// \file
/// Findings: what the instrument found wrong, or worth knowing, about a test or the bench, and what to do
/// about it. One list of codes for all sources.
///
///     add(results.findings, make_finding(FindingCode::kPullSpeed, "the pull speed was …", {{"plan", 0.00508,
///     "m/s"}}));
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace stickslip::base {

enum class Severity {
  kNote,     ///< The numbers are right; something could not be checked, or they describe less than it seems.
  kWarning,  ///< A number is off or less certain than it looks.
  kFault,    ///< Numbers are wrong until the cause is removed.
};
inline constexpr Severity kSeverities[] = {Severity::kFault, Severity::kWarning, Severity::kNote};

/// "note", "warning", "fault".
[[nodiscard]] std::string_view name(Severity severity) noexcept;
[[nodiscard]] std::optional<Severity> severity_from_name(std::string_view text) noexcept;

/// Code of a finding. finding_kinds() gives the name, severity, meaning and action of each, in this order.
enum class FindingCode : std::uint8_t {
  kNoSelfCheck,
  kSelfCheckSaturated,
  kSelfCheckSpikes,
  kSelfCheckZero,
  kSelfCheckDrift,
  kSelfCheckNoise,
  kSelfCheckHum,
  kSelfCheckRate,
  kScanRate,
  kFewScans,
  kSaturated,
  kClipped,
  kFrozen,
  kNoPull,
  kHum,
  kCoarseSteps,
  kBeginsUnderLoad,
  kHolds,
  kZeroOffset,
  kPullSpeed,
  kFastBelt,
  kSledMass,
  kCoefficient,
  kGainChange,
  kCalibrationExpired,
  kCalibrationLine,
  kCalibrationHysteresis,
  kRateUnchecked,
  kNotFitted,
  kMisfit,
  kTransducerShows,
  kLevelDrift,
  kSlack,
  kTesterChanged,
  kRepeatedScans,
  kTrendReference,
  kTrendOmega,
  kTrendDamping,
  kTrendZero,
  kTrendNoise,
  kTrendSpikes,
  kTrendRate,
  kUncoded,
};
inline constexpr std::size_t kFindingCodes = static_cast<std::size_t>(FindingCode::kUncoded) + 1;

/// A row of the table of codes; docs/findings.md holds the same rows.
struct FindingKind {
  FindingCode code;
  std::string_view name;    ///< Stable between versions: "zero-offset".
  std::string_view source;  ///< Check that finds it: "self-check", "clock", "zero" …
  Severity severity;
  std::string_view meaning;  ///< When it is found; one sentence without a full stop.
  std::string_view action;   ///< What to do, if anything; without a full stop.
};

[[nodiscard]] std::span<const FindingKind, kFindingCodes> finding_kinds() noexcept;
[[nodiscard]] const FindingKind& kind_of(FindingCode code) noexcept;

/// A number behind a finding.
struct FindingNumber {
  std::string name;
  double value = 0.0;
  std::string unit;  ///< SI unit of the value; "1" for a ratio or a count.

  bool operator==(const FindingNumber&) const = default;
};

/// One finding. It carries its code's severity and action with it, since a record of a newer version may have
/// codes that this version lacks.
struct Finding {
  std::string code;  ///< FindingKind::name.
  Severity severity = Severity::kWarning;
  std::string text;  ///< One sentence.
  std::string action;
  std::vector<FindingNumber> numbers = {};

  bool operator==(const Finding&) const = default;
};

/// Finding with the name, severity and action of its code.
/// \param text  one sentence. \param numbers  those that are not finite are left out.
[[nodiscard]] Finding make_finding(FindingCode code, std::string text,
                                   std::vector<FindingNumber> numbers = {});

/// Inserts a finding into a list that has the most severe first; behind those of its own severity.
void add(std::vector<Finding>& list, Finding finding);

/// The text of each finding, in the same order.
[[nodiscard]] std::vector<std::string> texts_of(std::span<const Finding> findings);

}  // namespace stickslip::base
