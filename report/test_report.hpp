/// \file
/// Reads the tests of one material, or of two to be compared, groups them by pull speed, grade and regime and
/// summarises them.
/// Reports as text, JSON, CSV and page are made from this.
#pragma once

#include <cstdint>
#include <filesystem>
#include <initializer_list>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "report/form_block.hpp"

#include "core/analysis/grouping.hpp"
#include "core/base/result.hpp"
#include "core/model/truth.hpp"
#include "core/record/record.hpp"
#include "daemon/types/batch.hpp"
#include "daemon/types/verdict.hpp"

namespace stickslip::report {

/// A test of a report: its record without the scans.
struct ReportedTest {
  std::string file;
  std::string title;
  std::string method;                   ///< Text of the test method, as in the record.
  std::string estimator = "fit";        ///< As in the record, if that names one.
  std::vector<std::string> departures;  ///< Departures from the method, one line each.
  record::SampleFacts sample;           ///< As in the record.
  std::string start_time;               ///< ISO 8601; empty if unknown.
  std::string speed;  ///< Pull speed in the method's unit, else as it was most likely typed; empty: unknown.
  RecordFacts facts;  ///< For the form.
  std::string scans_sha256;  ///< Of the raw values.
  std::optional<model::TestTruth> truth;
  std::string trace;  ///< json_for_script() of trace_json(), for the page; empty unless requested.
};

/// A void test: its record does not count and was not read.
struct VoidedTest {
  std::string file;
  daemon::Voiding voiding;
};

/// Tests of one material. `tests` and `measured` have equal lengths.
struct Material {
  std::string label;  ///< Empty if there is only one material.
  std::vector<ReportedTest> tests;
  std::vector<analysis::MeasuredTest> measured;
  std::vector<analysis::SpeedGroup> groups;
  std::vector<VoidedTest> voided;            ///< Void by the batch journals; in no number here.
  std::vector<daemon::LimitVerdict> limits;  ///< Checks of the batch's limits; empty without limits.
  analysis::Pooling pooling;
};

/// What is read of a record; each has what those before it have.
enum class Detail : std::uint8_t {
  kTables,   ///< The results that the tables of texts are made of; the others, rests among them, are absent.
  kResults,  ///< All results.
  kTraces,   ///< Fills ReportedTest::trace.
};

/// Reads records; the results are those in the files, not computed again. Void tests are listed and not read.
/// \param pooling  of the groups. Errors: that of the first file that cannot be read, with its name; kUsage
/// if all tests are void.
[[nodiscard]] base::Result<Material> read_material(std::string label, std::span<const std::string> files,
                                                   Detail detail, analysis::Pooling pooling);

/// Reads the tests of a batch and checks its limits. \param label  empty: the batch's name. \param id_or_name
/// as for BatchBook::find(). \param folder  the record folder. Errors: as read_material(); kUsage if there is
/// no such batch or it has no test.
[[nodiscard]] base::Result<Material> read_batch(std::string label, const std::string& id_or_name,
                                                const std::filesystem::path& folder, Detail detail,
                                                analysis::Pooling pooling);

/// "Thorold, 12 in/min, ring-down": what the tests of a group have in common, and what is pooled.
[[nodiscard]] std::string group_text(const Material& material, const analysis::SpeedGroup& group);

/// The pull speed of a group; "speed not known".
[[nodiscard]] std::string speed_of(const Material& material, const analysis::SpeedGroup& group);

/// Which groups at one speed are not averaged, and the option that averages them; empty: there are none.
[[nodiscard]] std::string not_pooled_text(const Material& material);

/// A comparison has no groups by grade: kUsage if the tests of a side have several and they are not pooled.
[[nodiscard]] base::Result<void> check_one_grade(const Material& material, std::string_view side);

/// More than one speed is known: something can be drawn against it.
[[nodiscard]] bool has_speeds(const Material& material);

/// Words of --pool: "grades", "regimes", or both with a comma between. \param place  of the value, for the
/// error: kUsage.
[[nodiscard]] base::Result<analysis::Pooling> pooling_from_text(std::string_view text,
                                                                std::string_view place);

/// Counts of tests at one speed by regime: `sticking` those that stuck again at least once (stick-slip,
/// mixed), `sliding` those that never did (ring-down, steady sliding). Undecided tests are not counted.
/// [Penner 1995] tells its two mills apart by this.
struct RegimeCounts {
  unsigned sticking = 0;
  unsigned sliding = 0;
};

struct RegimeComparison {
  RegimeCounts a;
  RegimeCounts b;
  std::optional<double> p;  ///< p value of Fisher's exact test; absent if a material has no counted test.
};

/// Adds a finding to each test whose scans an earlier test has too: a trace that was imported twice, or a
/// copy of a record.
void note_repeated_scans(std::initializer_list<Material*> materials);

/// All comparisons of two materials, in the order of pair_speeds() and report::quantities().
struct MaterialComparison {
  std::vector<analysis::SpeedPair> pairs;
  std::vector<std::array<analysis::Comparison, analysis::kQuantityCount>>
      comparisons;                                   ///< One for each pair.
  std::vector<analysis::PooledComparison> by_cycle;  ///< One for each pair.
  std::vector<RegimeComparison> regimes;             ///< One for each pair.
  struct Combined {
    double p = 0.0;  ///< Combined p value of all speeds (Fisher's method).
    int speed_count = 0;
  };
  std::array<std::optional<Combined>, analysis::kQuantityCount> combined;  ///< Absent below two speeds.
};

[[nodiscard]] MaterialComparison compare_materials(const Material& a, const Material& b);

}  // namespace stickslip::report
