#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "cli/subcommands.hpp"
#include "io/json_text.hpp"
#include "io/new_file.hpp"
#include <nlohmann/json.hpp>

#include "core/analysis/taps.hpp"
#include "core/base/text.hpp"
#include "core/base/wording.hpp"
#include "core/evaluation/analyse.hpp"
#include "core/record/finaliser.hpp"
#include "core/record/iso_time.hpp"
#include "core/record/read_apart.hpp"
#include "core/record/tester_file.hpp"

namespace stickslip::cli {
namespace {

using Json = nlohmann::ordered_json;
using analysis::Characterisation;
using analysis::TesterEstimate;

struct CharacteriseOptions {
  std::vector<std::string> files;  ///< Records of ring-downs, or of taps.
  std::string output;              ///< Empty: none.
  bool taps = false;
  bool json = false;
};

struct RingDowns {
  std::vector<TesterEstimate> estimates;  ///< One for each file.
  std::optional<std::int64_t> latest_ns;
};

/// What one record says; refused unless it is a ring-down that the model describes.
base::Result<TesterEstimate> ring_down_of(const std::string& file, record::Record record) {
  // Whatever the test itself was measured with.
  record.header.process.estimator = detect::name(detect::EstimatorTier::kFit);
  base::Result<evaluation::TesterAnalysis> test = evaluation::analyse_with_tester(record, {});
  if (!test)
    return tl::unexpected(base::Error{test.error().kind, fmt::format("{}: {}", file, test.error().message)});
  const analysis::TestResults& results = test->end.results;
  if (results.regime != model::Regime::kRingDown || !test->tester) {
    return base::usage_error(
        "{}: {}, but only a ring-down tells omega and gamma of the tester; pull faster than the threshold "
        "speed",
        file,
        results.regime == model::Regime::kRingDown
            ? results.omega.reason
            : fmt::format("the regime is {}", model::name(results.regime)));
  }
  return *test->tester;
}

base::Result<RingDowns> read_all(const std::vector<std::string>& files) {
  RingDowns ring_downs;
  for (std::size_t i = 0; i < files.size(); ++i) {
    const std::string& file = files[i];
    base::Result<record::Record> record = record::read_record_in_turn(files, i);
    if (!record) return tl::unexpected(record.error());
    ring_downs.latest_ns = std::max(ring_downs.latest_ns, record->header.start_realtime_ns);
    base::Result<TesterEstimate> estimate = ring_down_of(file, *std::move(record));
    if (!estimate) return tl::unexpected(estimate.error());
    ring_downs.estimates.push_back(*estimate);
  }
  return ring_downs;
}

double standard_error(const Eigen::Matrix3d& covariance, Eigen::Index i) {
  return std::sqrt(covariance(i, i));
}

/// \param of_what  "ring-downs"
std::string agreement_of(const Characterisation& result, std::string_view of_what) {
  if (result.freedom == 0) return {};
  return fmt::format(
      "chi-squared {:.2f} for {} degrees of freedom, probability {:.2g}{}\n", result.chi_squared,
      result.freedom, result.probability(),
      result.probability() < analysis::kDisagreement ? fmt::format(": the {} disagree", of_what) : "");
}

std::string table_of(const std::vector<std::string>& files, const RingDowns& ring_downs,
                     const Characterisation& result) {
  std::string text;
  const auto line = [&](double omega, double omega_error, double gamma, double gamma_error,
                        const std::string& name) {
    text += fmt::format("omega {:.4f} +- {:.4f} rad/s   gamma/2omega {:.6f} +- {:.6f}   {}\n", omega,
                        omega_error, gamma, gamma_error, name);
  };
  for (std::size_t i = 0; i < files.size(); ++i) {
    const TesterEstimate& one = ring_downs.estimates[i];
    line(one.omega, standard_error(one.covariance, 0), one.gamma_over_2omega,
         standard_error(one.covariance, 1), base::printable(files[i]));
  }
  const estimate::SharedPrior::Coupling& mean = result.coupling;
  line(mean.omega, std::sqrt(mean.covariance(0, 0)), mean.gamma_over_2omega, std::sqrt(mean.covariance(1, 1)),
       "the tester");
  return text + agreement_of(result, "ring-downs");
}

std::string json_of(const std::vector<std::string>& files, const RingDowns& ring_downs,
                    const Characterisation& result, const std::string& date) {
  Json tests = Json::array();
  for (std::size_t i = 0; i < files.size(); ++i) {
    const TesterEstimate& one = ring_downs.estimates[i];
    tests.push_back({{"file", files[i]},
                     {"omega", one.omega},
                     {"omega_standard_error", standard_error(one.covariance, 0)},
                     {"gamma_over_2omega", one.gamma_over_2omega},
                     {"gamma_over_2omega_standard_error", standard_error(one.covariance, 1)}});
  }
  const estimate::SharedPrior::Coupling& mean = result.coupling;
  const double omega_error = std::sqrt(mean.covariance(0, 0));
  const double gamma_error = std::sqrt(mean.covariance(1, 1));
  const Json tester{{"characterised", date},
                    {"ring_downs", result.ring_downs},
                    {"omega", mean.omega},
                    {"omega_standard_error", omega_error},
                    {"gamma_over_2omega", mean.gamma_over_2omega},
                    {"gamma_over_2omega_standard_error", gamma_error},
                    {"correlation", mean.covariance(0, 1) / omega_error / gamma_error},
                    {"chi_squared", result.chi_squared},
                    {"freedom", result.freedom},
                    {"probability", result.probability()}};
  const Json all{{"tester", tester}, {"ring_downs", std::move(tests)}};
  return io::json_document(all);
}

/// A tap, and where it is.
struct TapOfFile {
  std::string file;
  analysis::Tap tap;
};

struct TapsOfFiles {
  std::vector<TapOfFile> taps;
  std::vector<std::string> refused;  ///< "FILE, 0.512 s: …"
  double lowest_rate_Hz = 0.0;
  double highest_rate_Hz = 0.0;
};

/// Frequency and damping of the cell do not depend on the unit of the readings.
base::Result<TapsOfFiles> read_taps(const std::vector<std::string>& files) {
  TapsOfFiles found;
  for (std::size_t i = 0; i < files.size(); ++i) {
    const base::Result<record::Record> record = record::read_record_in_turn(files, i);
    if (!record) return tl::unexpected(record.error());
    const double rate_Hz = record->header.board.scan_rate_granted_Hz;
    if (!(rate_Hz > 0.0))
      return base::usage_error("{}: the record has no scan rate", base::printable(files[i]));
    found.lowest_rate_Hz = i == 0 ? rate_Hz : std::min(found.lowest_rate_Hz, rate_Hz);
    found.highest_rate_Hz = std::max(found.highest_rate_Hz, rate_Hz);
    const std::vector<daq::ScanIndex>& scans = record->scan;
    for (std::size_t first = 0, end = 0; first < scans.size(); first = end) {
      for (end = first + 1; end < scans.size() && scans[end] == scans[end - 1] + 1; ++end) {
      }
      const double begin_s = static_cast<double>(scans[first] - scans.front()) / rate_Hz;
      analysis::Taps taps = analysis::find_taps(std::span{record->raw}.subspan(first, end - first), rate_Hz);
      for (analysis::Tap& tap : taps.taps) {
        tap.at_s += begin_s;
        found.taps.push_back({files[i], tap});
      }
      for (const analysis::RefusedTap& refused : taps.refused)
        found.refused.push_back(
            fmt::format("{}, {:.3f} s: {}", base::printable(files[i]), refused.at_s + begin_s, refused.why));
    }
  }
  if (!found.taps.empty()) return found;
  if (found.refused.empty())
    return base::usage_error(
        "{}: no tap is found, no reading stands out of the noise: tap the cell, without the "
        "sled, while it is recorded",
        base::printable(files.front()));
  return base::usage_error("no tap tells the load cell: {}", found.refused.front());
}

Json number_and_error(const analysis::CellEstimate& cell) {
  return {{"load_cell_frequency", *cell.frequency_Hz.value},
          {"load_cell_frequency_standard_error", *cell.frequency_Hz.standard_error},
          {"load_cell_damping", *cell.damping_ratio.value},
          {"load_cell_damping_standard_error", *cell.damping_ratio.standard_error}};
}

std::string text_of(const analysis::CellEstimate& cell) {
  return fmt::format("{:10.3f} +- {:.3f} Hz   damping {:.5f} +- {:.5f}", *cell.frequency_Hz.value,
                     *cell.frequency_Hz.standard_error, *cell.damping_ratio.value,
                     *cell.damping_ratio.standard_error);
}

analysis::CellEstimate cell_of(const TesterEstimate& ring) {
  return analysis::cell_of(
      {ring.omega, ring.gamma_over_2omega, Eigen::Matrix2d{ring.covariance.topLeftCorner<2, 2>()}});
}

std::string table_of(const TapsOfFiles& found, const Characterisation& result,
                     const analysis::CellEstimate& cell) {
  std::string text;
  for (const TapOfFile& one : found.taps)
    text += fmt::format("{}   {:.3f} s, {}\n", text_of(cell_of(one.tap.ring)), one.tap.at_s,
                        base::printable(one.file));
  text += fmt::format("{}   the load cell\n", text_of(cell));
  text += agreement_of(result, "taps");
  for (const std::string& refused : found.refused) text += fmt::format("left out: {}\n", refused);
  const double frequency_Hz = *cell.frequency_Hz.value;
  const double seen_Hz = result.coupling.omega / (2.0 * std::numbers::pi);
  text += fmt::format(
      "\nIn the configuration:\n"
      "  [tester]\n"
      "  load_cell_frequency = \"{0:.6g} Hz\"\n"
      "  load_cell_damping = {1:.4g}\n"
      "or: --load-cell-frequency \"{0:.6g} Hz\" --load-cell-damping {1:.4g}\n",
      frequency_Hz, *cell.damping_ratio.value);
  if (found.lowest_rate_Hz == found.highest_rate_Hz)
    text += fmt::format(
        "At {:.6g} scans a second a cell that swings at {:.6g} Hz looks the same. Taps at another scan rate "
        "tell.\n",
        found.lowest_rate_Hz, analysis::alias_Hz(seen_Hz, found.lowest_rate_Hz));
  return text;
}

base::Result<std::string> characterise_cell(const CharacteriseOptions& options) {
  const base::Result<TapsOfFiles> found = read_taps(options.files);
  if (!found) return tl::unexpected(found.error());
  std::vector<TesterEstimate> rings;
  for (const TapOfFile& one : found->taps) rings.push_back(one.tap.ring);
  const std::optional<Characterisation> result = analysis::pool_ring_downs(rings);
  if (!result) return base::failure("the taps have no finite mean");
  const analysis::CellEstimate cell = analysis::cell_of(result->coupling);
  if (!options.json) return table_of(*found, *result, cell);
  Json taps = Json::array();
  for (const TapOfFile& one : found->taps) {
    Json tap{{"file", one.file}, {"time", one.tap.at_s}};
    tap.update(number_and_error(cell_of(one.tap.ring)));
    taps.push_back(std::move(tap));
  }
  Json tester = number_and_error(cell);
  tester.update(Json{{"chi_squared", result->chi_squared},
                     {"freedom", result->freedom},
                     {"probability", result->probability()}});
  return io::json_document(
      Json{{"tester", std::move(tester)}, {"taps", std::move(taps)}, {"left_out", found->refused}});
}

base::Result<std::string> run_characterise(const CharacteriseOptions& options) {
  if (options.taps) return characterise_cell(options);
  if (!options.output.empty()) {
    if (auto free = record::check_publishable(options.output); !free) return tl::unexpected(free.error());
  }
  const base::Result<RingDowns> ring_downs = read_all(options.files);
  if (!ring_downs) return tl::unexpected(ring_downs.error());
  const std::optional<Characterisation> result = analysis::pool_ring_downs(ring_downs->estimates);
  if (!result) return base::failure("the ring-downs have no finite mean");
  const std::string date = ring_downs->latest_ns ? record::iso_time(*ring_downs->latest_ns) : std::string{};
  if (!options.output.empty()) {
    if (auto written = io::write_new_file(options.output, record::tester_text(*result, date)); !written) {
      return tl::unexpected(written.error());
    }
  }
  return options.json ? json_of(options.files, *ring_downs, *result, date)
                      : table_of(options.files, *ring_downs, *result);
}

}  // namespace

void add_characterise(CLI::App& app, Chosen& chosen) {
  const auto options = std::make_shared<CharacteriseOptions>();
  CLI::App* command =
      app.add_subcommand("characterise", "find omega and gamma of the tester from its ring-downs");
  command->add_option("files", options->files, "records of ring-downs, or of taps")
      ->required()
      ->type_name("FILE.h5");
  CLI::Option* const output =
      command->add_option("-o,--output", options->output, "where to keep it, a file that does not exist")
          ->type_name("FILE.toml");
  command
      ->add_flag("--tap", options->taps,
                 "find natural frequency and damping of the load cell, from taps on it without the sled")
      ->excludes(output);
  command->add_flag("--json", options->json, "JSON instead of a table");
  command->footer(
      "Examples:\n"
      "  stickslip characterise ring-down-1.h5 ring-down-2.h5 -o tester.toml\n"
      "  stickslip characterise ring-down-1.h5 ring-down-2.h5 --json\n"
      "  stickslip analyze records/*.h5 --tester tester.toml\n"
      "  stickslip characterise --tap taps.h5");
  choose(*command, chosen, [options] { return run_characterise(*options); });
}

}  // namespace stickslip::cli
