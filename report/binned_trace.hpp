/// \file
/// Lowest and highest coefficient in equal parts of a record, with its cycles: what a page draws of a span of
/// any length, and what zooming asks for again.
#pragma once

#include <cstddef>
#include <optional>

#include <nlohmann/json_fwd.hpp>

#include "core/base/result.hpp"
#include "core/record/record.hpp"

namespace stickslip::report {

/// Bins of a trace if nobody says how many: about one for each pixel of a screen.
inline constexpr std::size_t kUsualBins = 2000;

struct TraceSpan {
  std::size_t bins = kUsualBins;   ///< At most so many, at least 1.
  std::optional<double> from_s{};  ///< After the record's first scan. Absent: from the start.
  std::optional<double> to_s{};    ///< Inclusive. Absent: to the end.
};

/// {"scan_count", "rate", "end", "scans_in_bin", "time", "lowest", "highest", "mu_s", "mu_k",
///  "cycles": {"number", "onset_time", "capture_time", "peak_time", "peak", "trough", "captured"},
///  "left_out_cycles"}.
/// A bin is the same number of scan indices everywhere: the smallest for which the span has at most
/// `span.bins` bins; 1 is full resolution. "time" is that of its first scan, s after the record's first scan;
/// "lowest" and "highest" are null if a gap has all of its scans. "end" is the time of the record's last
/// scan. The cycles are those that begin in the span, with the last before it and the first behind it; if
/// they are more than `span.bins` all are left out and counted. "mu_s" and "mu_k" are the S and K of the
/// result; unknown values are null. Errors: as coefficient_trace(); kUsage if `bins` is 0 or the span is not
/// in the record.
[[nodiscard]] base::Result<nlohmann::ordered_json> binned_trace_json(const record::Record& record,
                                                                     const TraceSpan& span);

}  // namespace stickslip::report
