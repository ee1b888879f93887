/// \file
/// Records from a trace that another program wrote: text, MATLAB or HDF5.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "io/traces/dialect.hpp"
#include "io/traces/own_table.hpp"
#include "io/traces/quantity_unit.hpp"

#include "core/base/result.hpp"
#include "core/record/record.hpp"

namespace stickslip::traces {

/// The file and the facts that it may not contain.
struct ImportRequest {
  std::string path;
  DialectOptions dialect;
  /// Heading or number of the values; empty: the file is a table of `stickslip export` (own_table.hpp).
  std::string column;
  std::string unit;         ///< Of the values; empty: of the heading or of the cells.
  std::string time_column;  ///< Heading or number; empty: by its name; "none": no column is a time.
  std::string time_unit;    ///< s, ms, us, ns, min or h; empty: of the heading, else by inspection.
  std::optional<double> rate_Hz;
  /// Now, ns since 1970: a later start is left out, as of times since 1904. Unlimited if absent.
  std::optional<std::int64_t> now_ns{};
  bool invert = false;        ///< The force is negative while sliding.
  bool reverse = false;       ///< Rows from the last to the first.
  bool resample = false;      ///< Scans at equal intervals by linear interpolation.
  bool skip_doubled = false;  ///< Leave out a row with the time of the row before it.
  record::TesterFacts tester;
  std::optional<daq::LoadCell> load_cell;  ///< For V and counts.
  std::optional<CountScale> counts;        ///< For counts.
  record::SampleFacts sample;
  record::ProcessFacts process;
  std::function<void(double)> progress{};  ///< As Source::progress.
  /// Folder of the scratch files for a trace that is longer than memory, as of base::LongColumn; empty: all
  /// in memory.
  std::filesystem::path scratch_folder{};
};

struct Imported {
  std::vector<ImportedTest> tests;  ///< One for each test of the trace, without results.
  std::string report;               ///< What was recognised and left out: lines for people.
  /// The test came back from an export: it has spikes, and an end with status and reasons.
  bool is_own = false;
};

/// The columns, with unit, first values, smallest and largest, and the command that imports them.
[[nodiscard]] base::Result<std::string> inspect(const ImportRequest& request);

/// Reads the file and makes records that are not analysed yet. Scans are at equal intervals; missing rows and
/// holes are gaps. A trace of several tests is cut where the force has returned to zero between them. Errors:
/// kUsage with place, value and a remedy; kFailure if the file cannot be read. Throws std::system_error that
/// names the scratch folder if that cannot hold the scans.
/// \param request  of a table of `stickslip export`: path and dialect alone, and process.method if it is
/// another one; the record's other facts are those that the table states.
[[nodiscard]] base::Result<Imported> import_trace(const ImportRequest& request);

}  // namespace stickslip::traces
