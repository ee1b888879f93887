#include <fmt/format.h>

#include <memory>
#include <string>
#include <utility>

#include "cli/method_option.hpp"
#include "cli/options.hpp"
#include "cli/subcommands.hpp"

#include "core/base/text.hpp"
#include "core/base/version.hpp"
#include "core/evaluation/analyse.hpp"
#include "core/record/csv_import.hpp"
#include "core/record/finaliser.hpp"
#include "core/record/method_text.hpp"

namespace stickslip::cli {
namespace {

using base::Dimension;
using base::Result;

/// Numbers as typed: "350", "350 Hz", "12 in/min"; bare numbers are in SI units.
struct ImportOptions {
  std::string csv;
  std::string column;
  std::string time_column;
  std::string rate;
  std::string unit;  ///< "coefficient", "N" or "V".
  std::string speed;
  std::string sled_mass;
  std::string stiffness;
  std::string load_cell_gain;
  std::string load_cell_zero;
  std::string method;  ///< As chosen_method() takes it.
  std::string output;
};

Result<daq::RawQuantity> quantity_of(const std::string& unit) {
  if (unit == "coefficient") return daq::RawQuantity::kCoefficient;
  if (unit == "N") return daq::RawQuantity::kForce_N;
  if (unit == "V") return daq::RawQuantity::kVolts;
  return base::usage_error("--unit: \"{}\" is unknown; allowed: coefficient, N, V", unit);
}

Result<record::CsvImportRequest> request_of(const ImportOptions& options) {
  record::CsvImportRequest request;
  request.path = options.csv;
  request.column = options.column;
  request.time_column = options.time_column;

  const Result<daq::RawQuantity> quantity = quantity_of(options.unit);
  if (!quantity) return tl::unexpected(quantity.error());
  request.quantity = *quantity;

  const auto rate_Hz = number_of("--rate", options.rate, Dimension::kFrequency, true);
  if (!rate_Hz) return tl::unexpected(rate_Hz.error());
  request.rate_Hz = rate_Hz->value_or(0.0);
  const auto speed = number_of("--speed", options.speed, Dimension::kSpeed, true);
  if (!speed) return tl::unexpected(speed.error());
  request.tester.pull_speed_m_per_s = *speed;
  const auto mass = number_of("--sled-mass", options.sled_mass, Dimension::kMass, true);
  if (!mass) return tl::unexpected(mass.error());
  request.tester.sled_mass_kg = *mass;
  const auto stiffness = number_of("--stiffness", options.stiffness, Dimension::kStiffness, true);
  if (!stiffness) return tl::unexpected(stiffness.error());
  request.tester.stiffness_N_per_m = *stiffness;
  const auto gain = number_of("--load-cell-gain", options.load_cell_gain, Dimension::kForcePerVoltage, false);
  if (!gain) return tl::unexpected(gain.error());
  const auto zero = number_of("--load-cell-zero", options.load_cell_zero, Dimension::kVoltage, false);
  if (!zero) return tl::unexpected(zero.error());

  if (*quantity == daq::RawQuantity::kVolts) {
    if (!*gain || **gain == 0.0) {
      return base::usage_error("--unit V needs --load-cell-gain, not 0, such as \"2 N/V\"");
    }
    request.load_cell = daq::LoadCell{**gain, zero->value_or(0.0)};
  } else if (*gain || *zero) {
    return base::usage_error("--load-cell-gain and --load-cell-zero are for --unit V only");
  }
  if (*quantity != daq::RawQuantity::kCoefficient && !*mass) {
    return base::usage_error("--unit {} needs --sled-mass: a coefficient is force over the sled's weight",
                             options.unit);
  }
  request.process.program = "stickslip import";
  request.process.version = base::kVersion;
  request.process.commit = base::kCommit;
  const Result<model::Method> method = chosen_method(options.method);
  if (!method) return tl::unexpected(method.error());
  request.process.method = record::method_text(*method);
  return request;
}

Result<std::string> run_import(const ImportOptions& options) {
  const Result<record::CsvImportRequest> request = request_of(options);
  if (!request) return tl::unexpected(request.error());
  Result<record::Record> record = record::read_csv(*request);
  if (!record) return tl::unexpected(record.error());
  Result<record::EndRecord> end = evaluation::analyse(*record);
  if (!end) return tl::unexpected(end.error());
  end->reasons.clear();
  const std::size_t scans = record->scan.size();
  record::set_end(*record, std::move(*end));
  if (const Result<void> published = record::publish_record(*record, options.output); !published) {
    return tl::unexpected(published.error());
  }
  return fmt::format("{}: {} scans\n", base::printable(options.output), scans);
}

}  // namespace

void add_import(CLI::App& app, Chosen& chosen) {
  const auto options = std::make_shared<ImportOptions>();
  CLI::App* command = app.add_subcommand("import", "make a record from a measured trace in a CSV file");
  command->add_option("csv", options->csv, "file with a header line")->required()->type_name("FILE.csv");
  command->add_option("--column", options->column, "header of the column with the values")
      ->required()
      ->type_name("NAME");
  command->add_option("--rate", options->rate, "scans per second; a time column is checked against it")
      ->required()
      ->type_name("HZ");
  command->add_option("--unit", options->unit, "of the values: coefficient, N or V")
      ->required()
      ->type_name("UNIT");
  command->add_option("-o,--output", options->output, "record to make; must not exist")
      ->required()
      ->type_name("FILE.h5");
  command
      ->add_option("--time-column", options->time_column,
                   "header of the time in s (else t, t_s, time, time_s)")
      ->type_name("NAME");
  add_method_option(*command, options->method);
  command->add_option("--speed", options->speed, "pull speed, m/s or with unit")->type_name("V");
  command->add_option("--sled-mass", options->sled_mass, "kg or with unit; needed for N and V")
      ->type_name("M");
  command->add_option("--stiffness", options->stiffness, "of the coupling, N/m or with unit")->type_name("K");
  command->add_option("--load-cell-gain", options->load_cell_gain, "N/V or with unit; needed for V")
      ->type_name("GAIN");
  command->add_option("--load-cell-zero", options->load_cell_zero, "V or with unit; for V, default 0 V")
      ->type_name("ZERO");
  choose(*command, chosen, [options] { return run_import(*options); });
}

}  // namespace stickslip::cli
