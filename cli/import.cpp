#include <fmt/format.h>

#include <utility>

#include "cli/commands.hpp"
#include "cli/method_option.hpp"
#include "cli/options.hpp"

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

Result<daq::RawQuantity> quantity_of(const std::string& unit) {
  if (unit == "coefficient") return daq::RawQuantity::kCoefficient;
  if (unit == "N") return daq::RawQuantity::kForce_N;
  if (unit == "V") return daq::RawQuantity::kVolts;
  return base::usage_error("--unit: \"{}\" is unknown; allowed: coefficient, N, V", unit);
}

Result<record::CsvImportRequest> request_of(const ImportCommand& command) {
  record::CsvImportRequest request;
  request.path = command.csv;
  request.column = command.column;
  request.time_column = command.time_column;

  const Result<daq::RawQuantity> quantity = quantity_of(command.unit);
  if (!quantity) return tl::unexpected(quantity.error());
  request.quantity = *quantity;

  const auto rate_Hz = number_of("--rate", command.rate, Dimension::kFrequency, true);
  if (!rate_Hz) return tl::unexpected(rate_Hz.error());
  request.rate_Hz = rate_Hz->value_or(0.0);
  const auto speed = number_of("--speed", command.speed, Dimension::kSpeed, true);
  if (!speed) return tl::unexpected(speed.error());
  request.tester.pull_speed_m_per_s = *speed;
  const auto mass = number_of("--sled-mass", command.sled_mass, Dimension::kMass, true);
  if (!mass) return tl::unexpected(mass.error());
  request.tester.sled_mass_kg = *mass;
  const auto stiffness = number_of("--stiffness", command.stiffness, Dimension::kStiffness, true);
  if (!stiffness) return tl::unexpected(stiffness.error());
  request.tester.stiffness_N_per_m = *stiffness;
  const auto gain = number_of("--load-cell-gain", command.load_cell_gain, Dimension::kForcePerVoltage, false);
  if (!gain) return tl::unexpected(gain.error());
  const auto zero = number_of("--load-cell-zero", command.load_cell_zero, Dimension::kVoltage, false);
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
                             command.unit);
  }
  request.process.program = "stickslip import";
  request.process.version = base::kVersion;
  request.process.commit = base::kCommit;
  const Result<model::Method> method = chosen_method(command.method);
  if (!method) return tl::unexpected(method.error());
  request.process.method = record::method_text(*method);
  return request;
}

}  // namespace

Result<std::string> run_import(const ImportCommand& command) {
  const Result<record::CsvImportRequest> request = request_of(command);
  if (!request) return tl::unexpected(request.error());
  Result<record::Record> record = record::read_csv(*request);
  if (!record) return tl::unexpected(record.error());
  Result<record::EndRecord> end = evaluation::analyse(*record);
  if (!end) return tl::unexpected(end.error());
  end->reasons.clear();
  const std::size_t scans = record->scan.size();
  record::set_end(*record, std::move(*end));
  if (const Result<void> published = record::publish_record(*record, command.output); !published) {
    return tl::unexpected(published.error());
  }
  return fmt::format("{}: {} scans\n", base::printable(command.output), scans);
}

}  // namespace stickslip::cli
