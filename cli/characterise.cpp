#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "cli/subcommands.hpp"
#include "io/json_text.hpp"
#include "io/new_file.hpp"
#include <nlohmann/json.hpp>

#include "core/base/text.hpp"
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
  std::vector<std::string> files;  ///< Records of ring-downs.
  std::string output;              ///< Empty: none.
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
  if (result.freedom > 0) {
    text += fmt::format("chi-squared {:.2f} for {} degrees of freedom, probability {:.2g}{}\n",
                        result.chi_squared, result.freedom, result.probability(),
                        result.probability() < analysis::kDisagreement ? ": the ring-downs disagree" : "");
  }
  return text;
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

base::Result<std::string> run_characterise(const CharacteriseOptions& options) {
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
  command->add_option("files", options->files, "records of ring-downs")->required()->type_name("FILE.h5");
  command->add_option("-o,--output", options->output, "where to keep it, a file that does not exist")
      ->type_name("FILE.toml");
  command->add_flag("--json", options->json, "JSON instead of a table");
  command->footer(
      "Examples:\n"
      "  stickslip characterise ring-down-1.h5 ring-down-2.h5 -o tester.toml\n"
      "  stickslip characterise ring-down-1.h5 ring-down-2.h5 --json\n"
      "  stickslip analyze records/*.h5 --tester tester.toml");
  choose(*command, chosen, [options] { return run_characterise(*options); });
}

}  // namespace stickslip::cli
