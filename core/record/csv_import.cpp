#include "core/record/csv_import.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/record/csv_table.hpp"

namespace stickslip::record {
namespace {

const std::vector<std::string> kTimeColumns{"t_s", "t", "time_s", "time"};
/// Slack for comparing a rounded number with its rounding error, itself computed.
constexpr double kRoundingSlack = 1.0 + 1e-6;
/// Of a digit: anything between the binary rounding and one digit serves.
constexpr double kAlmostNone = 0.1;

base::Result<void> check_positive(const char* what, std::optional<double> value, const char* unit) {
  if (value && (!(*value > 0.0) || !std::isfinite(*value))) {
    return base::usage_error("{} {} {}: must be positive and finite", what, *value, unit);
  }
  return {};
}

base::Result<void> check_request(const CsvImportRequest& request) {
  if (request.quantity == daq::RawQuantity::kCounts) {
    return base::usage_error("counts cannot be imported: coefficient, N or V is needed");
  }
  if (auto ok = check_positive("rate", request.rate_Hz, "Hz"); !ok) return ok;
  const TesterFacts& tester = request.tester;
  if (auto ok = check_positive("sled mass", tester.sled_mass_kg, "kg"); !ok) return ok;
  if (auto ok = check_positive("gravity", tester.gravity_m_per_s2, "m/s²"); !ok) return ok;
  if (auto ok = check_positive("pull speed", tester.pull_speed_m_per_s, "m/s"); !ok) return ok;
  return check_positive("stiffness", tester.stiffness_N_per_m, "N/m");
}

/// How far two printed times may be from `distance_s` apart: half a digit of each, plus their binary
/// rounding. Where the distance is a whole number of digits both are rounded alike and nothing may
/// differ; otherwise a lost row would pass where the step is one digit.
double tolerance_s(const CsvColumn& time, double a, double b, double distance_s) {
  constexpr double kBinary = 8.0 * std::numeric_limits<double>::epsilon();
  const double binary_s = kBinary * std::max({std::abs(a), std::abs(b), distance_s});
  const double digit_s = time.resolution(a);
  const bool same_digit = digit_s == time.resolution(b);
  if (same_digit && std::abs(std::remainder(distance_s, digit_s)) <= binary_s) {
    return kAlmostNone * digit_s + binary_s;
  }
  return 0.5 * (digit_s + time.resolution(b)) * kRoundingSlack + binary_s;
}

/// Every step, and every time since the first row: small steps can hide in coarse digits.
base::Result<void> check_time(const CsvImportRequest& request, const CsvTable& table) {
  const std::vector<double>& time = table.time.values;
  const double step_s = 1.0 / request.rate_Hz;
  const std::string path = request.path.string();
  for (std::size_t i = 1; i < time.size(); ++i) {
    const double elapsed_s = static_cast<double>(i) * step_s;
    const double expected_s = time.front() + elapsed_s;
    const bool step_fits =
        std::abs(time[i] - time[i - 1] - step_s) <= tolerance_s(table.time, time[i], time[i - 1], step_s);
    const bool time_fits =
        std::abs(time[i] - expected_s) <= tolerance_s(table.time, time[i], time.front(), elapsed_s);
    if (step_fits && time_fits) continue;
    const double measured_Hz = static_cast<double>(time.size() - 1) / (time.back() - time.front());
    return base::usage_error(
        "{}:{}: column '{}' is {} s in row {}, {:.{}f} s expected at {} Hz; the whole column runs at {:.6g} "
        "Hz: "
        "correct the rate, or the rows if some are missing",
        path, table.line[i], table.time.name, time[i], i + 1, step_fits ? expected_s : time[i - 1] + step_s,
        std::max(table.time.decimals, 0), request.rate_Hz, measured_Hz);
  }
  return {};
}

}  // namespace

base::Result<Record> read_csv(const CsvImportRequest& request) {
  if (auto ok = check_request(request); !ok) return tl::unexpected(ok.error());
  const auto& time_columns =
      request.time_column.empty() ? kTimeColumns : std::vector<std::string>{request.time_column};
  auto table = read_csv_table(request.path, request.column, time_columns);
  if (!table) return tl::unexpected(table.error());
  if (!request.time_column.empty() && table->time.name.empty()) {
    return base::usage_error("{}:1: there is no column '{}' for the time", request.path.string(),
                             request.time_column);
  }
  if (auto ok = check_time(request, *table); !ok) return tl::unexpected(ok.error());

  Record record;
  RecordHeader& header = record.header;
  header.uuid = make_uuid();
  header.title = request.path.stem().string();
  header.board.driver = "import";
  header.board.device = request.path.filename().string();
  header.board.quantity = request.quantity;
  header.board.scan_rate_requested_Hz = request.rate_Hz;
  header.board.scan_rate_granted_Hz = request.rate_Hz;
  header.load_cell = request.load_cell;
  header.tester = request.tester;
  header.process = request.process;
  record.raw = std::move(table->values.values);
  record.scan.resize(record.raw.size());
  std::iota(record.scan.begin(), record.scan.end(), daq::ScanIndex{0});
  record.end.emplace().results = absent_results("not analysed");
  record.end->cause = "end-of-input";
  return record;
}

}  // namespace stickslip::record
