#include "core/record/judge.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <span>

#include "core/daq/rate_fit.hpp"
#include "core/record/journal_format.hpp"

namespace stickslip::record {
namespace {

/// Largest relative difference of the rate that the clocks imply from the rate granted: what the daemon
/// accepts at most of a board by default ([board.comedi] scan_rate_tolerance). Crystals differ by 1e-4.
constexpr double kRateTolerance = 0.01;
/// Standard errors of the fitted rate beyond which a deviation is certain: 1 in 3.5 million.
constexpr double kCertain = 5.0;
/// Step of the date during a test beyond which a note is made; NTP slews by 0.5 ms/s.
constexpr double kClockStep_ns = 1e9;

bool begins_as_journal(const GivenFile& file) {
  std::array<char, 4> magic{};
  return file.read(std::as_writable_bytes(std::span{magic}), 0) == static_cast<ssize_t>(magic.size()) &&
         magic == EntryHead{}.magic;
}

Judgement worst(const std::vector<Finding>& findings) {
  Judgement judgement = Judgement::kComplete;
  for (const Finding& finding : findings) {
    if (finding.weight == Finding::Weight::kDamage) return Judgement::kDamaged;
    if (finding.weight == Finding::Weight::kIncomplete) judgement = Judgement::kIncomplete;
  }
  return judgement;
}

}  // namespace

std::string_view name(Judgement judgement) noexcept {
  switch (judgement) {
    case Judgement::kComplete:
      return "complete";
    case Judgement::kIncomplete:
      return "incomplete";
    case Judgement::kDamaged:
      return "damaged";
    case Judgement::kNotJudged:
      return "not judged";
  }
  return "not judged";
}

std::string_view name(Finding::Weight weight) noexcept {
  switch (weight) {
    case Finding::Weight::kNote:
      return "note";
    case Finding::Weight::kIncomplete:
      return "incomplete";
    case Finding::Weight::kDamage:
      return "damage";
  }
  return "note";
}

void judge_clocks(const Record& record, daq::ScanIndex first, daq::ScanIndex end, Verdict& verdict) {
  const std::vector<ClockAnchor>& anchors = record.anchors;
  for (std::size_t i = 0; i < anchors.size(); ++i) {
    const std::string place = fmt::format("timing row {}", i);
    if (anchors[i].scan < first || anchors[i].scan >= end) {
      const std::string text = fmt::format("scan {} is not of this test", anchors[i].scan);
      // A stop can take the last scans and leave the clock that was read at them, damage the first ones too.
      if (verdict.status != name(Status::kComplete)) {
        verdict.note(place, text);
      } else {
        verdict.damage(place, text);
      }
    }
    if (i == 0) continue;
    if (anchors[i].scan <= anchors[i - 1].scan) verdict.damage(place, "the scans do not rise");
    if (anchors[i].monotonic_ns <= anchors[i - 1].monotonic_ns)
      verdict.damage(place, "the monotonic clock does not rise");
  }
  if (anchors.size() < 2 || worst(verdict.findings) == Judgement::kDamaged) return;
  const double step_ns = static_cast<double>(anchors.back().realtime_ns - anchors.front().realtime_ns) -
                         static_cast<double>(anchors.back().monotonic_ns - anchors.front().monotonic_ns);
  if (std::abs(step_ns) > kClockStep_ns) {
    verdict.note("timing",
                 fmt::format("the clock of the day was set by {:.3f} s during the test", step_ns * 1e-9));
  }
  const double granted_Hz = record.header.board.scan_rate_granted_Hz;
  const auto rate = daq::fit_rate(anchors, record.gaps, granted_Hz);
  if (!rate) {
    if (anchors.size() >= static_cast<std::size_t>(daq::RateFit::kFewestAnchors)) {
      verdict.note("timing", "the scans were read late: their clock readings cannot tell the scan rate");
    }
    return;
  }
  const double difference_Hz = std::abs(rate->rate_Hz - granted_Hz);
  if (difference_Hz > kRateTolerance * granted_Hz + kCertain * rate->standard_error_Hz) {
    verdict.incomplete("timing", fmt::format("the clocks say {:.3f} Hz, the board granted {:.3f} Hz: times "
                                             "are not to be relied on",
                                             rate->rate_Hz, granted_Hz));
  }
}

void judge_facts(const RecordHeader& header, Verdict& verdict) {
  const daq::BoardInfo& board = header.board;
  if (!(board.scan_rate_granted_Hz > 0.0) || !std::isfinite(board.scan_rate_granted_Hz))
    verdict.damage("timing/scan_rate_granted", "is not positive");
  if (header.uuid.empty()) verdict.damage("entry_identifier_uuid", "is missing");
  if (board.quantity == daq::RawQuantity::kCounts || board.quantity == daq::RawQuantity::kVolts) {
    if (!header.load_cell)
      verdict.damage("instrument/calibration/gain", "is missing: the raw values mean nothing without");
  }
  if (board.quantity == daq::RawQuantity::kCounts && board.polynomial.empty())
    verdict.damage("instrument/adc/polynomial", "is missing: the counts mean nothing without");
  if (header.process.program == "stickslipd" && header.process.configuration.empty())
    verdict.incomplete("process/configuration", "is missing: how the test was configured is not known");
  if (board.driver == "comedi" && header.calibration.date.empty())
    verdict.note("instrument/calibration", "says no date of the load cell's calibration");
}

void judge_gaps(const std::vector<daq::Gap>& gaps, Verdict& verdict) {
  verdict.gaps = gaps;
  for (const daq::Gap& gap : gaps) {
    verdict.incomplete(
        "gaps", fmt::format("{}{} scans missing from scan {}: {}", gap.estimated ? "about " : "", gap.count,
                            gap.first, daq::name(gap.cause)));
  }
}

void judge_status(const EndRecord& end, Verdict& verdict) {
  verdict.status = name(end.status);
  if (end.status == Status::kComplete) return;
  std::string why;
  for (const std::string& reason : end.reasons) why += (why.empty() ? ": " : "; ") + reason;
  verdict.incomplete("process/status", verdict.status + why);
}

Verdict judge(const std::filesystem::path& path, const FileCalls& calls) {
  Verdict verdict;
  const auto cannot_look = [](const std::string& why) {
    Verdict none;
    none.note("file", why);
    return none;
  };
  const auto given = GivenFile::open(path, calls);
  if (!given) return cannot_look(given.error().message);
  // By its content, or by its name where nothing of the content is left. A journal is locked while it is
  // written, and may be looked at.
  const bool is_journal = begins_as_journal(*given) || path.extension() == ".journal";
  if (!is_journal) {
    if (const auto shared = given->share(); !shared) return cannot_look(shared.error().message);
  }
  if (given->load()) {
    if (is_journal) {
      judge_journal(path, verdict);
    } else {
      judge_record(*given, path, verdict);
    }
  }
  if (given->refused() != 0) return cannot_look(why_unreadable(given->refused()));
  if (!verdict.kind.empty()) verdict.judgement = worst(verdict.findings);
  return verdict;
}

}  // namespace stickslip::record
