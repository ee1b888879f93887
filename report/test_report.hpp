/// \file
/// One material, or two to be compared: records read, grouped by speed, summarised. What terminal, JSON, CSV
/// and page show is made from this.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/analysis/grouping.hpp"
#include "core/base/result.hpp"
#include "core/model/truth.hpp"
#include "core/record/record.hpp"
#include "daemon/types/batch.hpp"
#include "daemon/types/verdict.hpp"

namespace stickslip::report {

/// One record without its scans.
struct ReportedTest {
  std::string file;
  std::string title;
  std::string method;                   ///< As in the record.
  std::string estimator = "fit";        ///< As in the record, where that names one.
  std::vector<std::string> departures;  ///< From the method, one line each.
  std::optional<model::TestTruth> truth;
  std::string trace;  ///< For the page: trace_json() as text; empty unless asked for.
};

/// One record that does not count, and was not read.
struct VoidedTest {
  std::string file;
  daemon::Voiding voiding;
};

/// Tests of one material. `tests` and `measured` have equal lengths.
struct Material {
  std::string label;  ///< Empty where there is only one.
  std::vector<ReportedTest> tests;
  std::vector<analysis::MeasuredTest> measured;
  std::vector<analysis::SpeedGroup> groups;
  std::vector<VoidedTest> voided;            ///< By the journals beside the records; in no number here.
  std::vector<daemon::LimitVerdict> limits;  ///< Of a batch that has such.
};

/// Results are those in the files.
/// \param with_traces  for the page.
/// What is void is left out and listed. Errors, one line that names the file: of the first that cannot be
/// read; kUsage if all are void.
[[nodiscard]] base::Result<Material> read_material(std::string label, std::span<const std::string> files,
                                                   bool with_traces);

/// The tests of a batch, with its limits. \param label  as above. \param id_or_name  of the batch. \param
/// folder  of its records. Errors: as above; kUsage if there is no such batch or it has no test.
[[nodiscard]] base::Result<Material> read_batch(std::string label, const std::string& id_or_name,
                                                const std::filesystem::path& folder, bool with_traces);

/// How many tests at one speed stuck again at least once (stick-slip, mixed), and how many never did
/// (ring-down, steady sliding): the paper's qualitative difference between its two mills. Undecided ones are
/// not counted.
struct RegimeCounts {
  unsigned sticking = 0;
  unsigned sliding = 0;
};

struct RegimeComparison {
  RegimeCounts a;
  RegimeCounts b;
  std::optional<double> p;  ///< Fisher's exact test; none where a material has no test to count.
};

/// All comparisons of two materials, in the order of pair_speeds() and report::quantities().
struct MaterialComparison {
  std::vector<analysis::SpeedPair> pairs;
  std::vector<std::array<analysis::Comparison, analysis::kQuantityCount>>
      comparisons;                                   ///< One for each pair.
  std::vector<analysis::PooledComparison> by_cycle;  ///< One for each pair.
  std::vector<RegimeComparison> regimes;             ///< One for each pair.
  struct Combined {
    double p = 0.0;  ///< Of all speeds together (Fisher).
    int speed_count = 0;
  };
  std::array<std::optional<Combined>, analysis::kQuantityCount> combined;  ///< None below two speeds.
};

[[nodiscard]] MaterialComparison compare_materials(const Material& a, const Material& b);

}  // namespace stickslip::report
