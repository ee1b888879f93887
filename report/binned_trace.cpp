#include "report/binned_trace.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "report/record_trace.hpp"
#include "report/rounded_json.hpp"

#include "core/base/nan.hpp"

namespace stickslip::report {
namespace {

using Json = nlohmann::ordered_json;

/// Indices of scans after the first, half-open.
struct ScanSpan {
  std::int64_t first = 0;
  std::int64_t end = 0;
};

struct Bins {
  std::int64_t scans_in_bin = 1;
  std::vector<double> time_s;
  std::vector<double> lowest;
  std::vector<double> highest;
};

/// \param last_s  time of the last scan.
base::Result<ScanSpan> scans_within(const TraceSpan& span, double last_s, double rate_Hz) {
  const double from_s = span.from_s.value_or(0.0);
  const double to_s = span.to_s.value_or(last_s);
  if (!(from_s >= 0.0 && from_s <= last_s))
    return base::usage_error("from {} s: must be from 0 s to {:.6g} s, the end of the record", from_s,
                             last_s);
  if (!(to_s > from_s))
    return base::usage_error("to {} s: must be above {:.6g} s, where the span begins", to_s, from_s);
  // A time that was rounded to 1e-6 s, as in the answer, means its scan.
  constexpr double kRounded_s = 1e-6;
  const auto first = static_cast<std::int64_t>(std::ceil((from_s - kRounded_s) * rate_Hz));
  const auto end = static_cast<std::int64_t>(std::floor((std::min(to_s, last_s) + kRounded_s) * rate_Hz)) + 1;
  if (first >= end)
    return base::usage_error("from {} s to {} s there is no scan: they come every {:.6g} s", from_s, to_s,
                             1.0 / rate_Hz);
  return ScanSpan{std::max<std::int64_t>(first, 0), end};
}

Bins bins_of(const RecordTrace& trace, const ScanSpan& scans, double rate_Hz, std::size_t most) {
  Bins bins;
  const auto count = static_cast<std::int64_t>(std::min<std::uint64_t>(most, INT64_MAX));
  bins.scans_in_bin = (scans.end - scans.first - 1) / count + 1;
  const auto size = static_cast<std::size_t>((scans.end - scans.first - 1) / bins.scans_in_bin + 1);
  bins.lowest.assign(size, base::kNaN);
  bins.highest.assign(size, base::kNaN);
  for (std::size_t bin = 0; bin < size; ++bin) {
    const std::int64_t scan = scans.first + static_cast<std::int64_t>(bin) * bins.scans_in_bin;
    bins.time_s.push_back(static_cast<double>(scan) / rate_Hz);
  }
  for (std::size_t i = 0; i < trace.value.size(); ++i) {
    const std::int64_t scan = std::llround(trace.time_s[i] * rate_Hz);
    if (scan < scans.first || scan >= scans.end || !std::isfinite(trace.value[i])) continue;
    const auto bin = static_cast<std::size_t>((scan - scans.first) / bins.scans_in_bin);
    // The other operand is returned where one is NaN.
    bins.lowest[bin] = std::fmin(bins.lowest[bin], trace.value[i]);
    bins.highest[bin] = std::fmax(bins.highest[bin], trace.value[i]);
  }
  return bins;
}

/// Fills in "cycles" and "left_out_cycles".
void add_cycles(Json& json, const base::LongColumn<detect::Cycle>& cycles, double from_s, double to_s,
                std::size_t most) {
  std::size_t first = 0;
  while (first < cycles.size() && !(cycles[first].peak_time_s >= from_s)) ++first;
  std::size_t end = first;
  while (end < cycles.size() && !(cycles[end].peak_time_s > to_s)) ++end;
  first -= std::min<std::size_t>(first, 1);
  end += end < cycles.size() ? 1 : 0;
  const bool too_many = end - first > most;
  json["cycles"] = {{"number", Json::array()},       {"onset_time", Json::array()},
                    {"capture_time", Json::array()}, {"peak_time", Json::array()},
                    {"peak", Json::array()},         {"trough", Json::array()},
                    {"captured", Json::array()}};
  json["left_out_cycles"] = too_many ? end - first : 0;
  if (too_many) return;
  for (std::size_t i = first; i < end; ++i) {
    const detect::Cycle cycle = cycles[i];
    json["cycles"]["number"].push_back(cycle.number);
    json["cycles"]["onset_time"].push_back(rounded(cycle.onset_time_s));
    json["cycles"]["capture_time"].push_back(rounded(cycle.capture_time_s));
    json["cycles"]["peak_time"].push_back(rounded(cycle.peak_time_s));
    json["cycles"]["peak"].push_back(rounded(cycle.peak));
    json["cycles"]["trough"].push_back(rounded(cycle.trough));
    json["cycles"]["captured"].push_back((cycle.flags & detect::kCycleCaptured) != 0);
  }
}

Json estimate(const record::Record& record, analysis::Estimate analysis::TestResults::*member) {
  if (!record.end) return nullptr;
  const analysis::Estimate& own = record.end->results.*member;
  return own.value ? rounded(*own.value) : Json(nullptr);
}

}  // namespace

base::Result<Json> binned_trace_json(const record::Record& record, const TraceSpan& span) {
  if (span.bins == 0) return base::usage_error("0 points: must be 1 or more");
  const base::Result<RecordTrace> trace = coefficient_trace(record);
  if (!trace) return tl::unexpected(trace.error());
  if (trace->time_s.empty()) return base::usage_error("the record has no scans");
  const double rate_Hz = record.header.board.scan_rate_granted_Hz;
  const double last_s = trace->time_s.back();
  const base::Result<ScanSpan> scans = scans_within(span, last_s, rate_Hz);
  if (!scans) return tl::unexpected(scans.error());
  const Bins bins = bins_of(*trace, *scans, rate_Hz, span.bins);
  Json json{{"scan_count", record.scan.size()},
            {"rate", rate_Hz},
            {"end", rounded(last_s)},
            {"scans_in_bin", bins.scans_in_bin},
            {"time", rounded(bins.time_s)},
            {"lowest", rounded(bins.lowest)},
            {"highest", rounded(bins.highest)},
            {"mu_s", estimate(record, &analysis::TestResults::mu_s)},
            {"mu_k", estimate(record, &analysis::TestResults::mu_k)}};
  add_cycles(json, record.cycles, bins.time_s.front(), static_cast<double>(scans->end) / rate_Hz, span.bins);
  return json;
}

}  // namespace stickslip::report
