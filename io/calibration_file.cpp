#include "io/calibration_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "io/new_file.hpp"

#include "core/base/contract.hpp"
#include "core/base/settings.hpp"
#include "core/record/iso_time.hpp"

namespace stickslip::io {
namespace {

using base::Dimension;
using base::Limits;

/// A quoted TOML string.
std::string toml_string(std::string_view text) {
  std::string result{"\""};
  for (const char c : text) {
    if (c == '"' || c == '\\') result += '\\';
    result += static_cast<unsigned char>(c) < 0x20 ? ' ' : c;
  }
  return result + '"';
}

std::string line(std::string_view key, std::optional<double> value, std::string_view unit,
                 std::string_view comment) {
  if (!value) return {};
  return fmt::format("{} = \"{} {}\"  # {}\n", key, *value, unit, comment);
}

base::Result<StoredCalibration> calibration_of(base::Settings settings) {
  StoredCalibration result;
  record::CalibrationFacts& facts = result.facts;
  base::Settings table = settings.table("calibration");
  facts.date = table.text("date");
  facts.expires = table.text("expires", "");
  facts.certificate = table.text("certificate", "");
  for (const char* key : {"date", "expires"}) {
    const std::string& text = key == std::string_view{"date"} ? facts.date : facts.expires;
    if (!text.empty() && !record::ns_from_iso_time(text)) {
      table.refuse(key, "must be a time such as \"2026-11-22T10:15:00.000000000+00:00\"");
    }
  }
  result.load_cell.gain_N_per_V = table.quantity("gain", Dimension::kForcePerVoltage, Limits::any());
  if (result.load_cell.gain_N_per_V == 0.0) table.refuse("gain", "must not be 0");
  result.load_cell.zero_V = table.quantity("zero", Dimension::kVoltage, Limits::any());
  const auto volts = [&table](const char* key, Limits limits) {
    return table.quantity_if_given(key, Dimension::kVoltage, limits);
  };
  facts.gain_standard_error_N_per_V =
      table.quantity_if_given("gain_standard_error", Dimension::kForcePerVoltage, Limits::at_least(0.0));
  facts.zero_standard_error_V = volts("zero_standard_error", Limits::at_least(0.0));
  facts.residual_V = volts("residual", Limits::at_least(0.0));
  facts.hysteresis_V = volts("hysteresis", Limits::any());
  facts.replaced_gain_N_per_V =
      table.quantity_if_given("replaced_gain", Dimension::kForcePerVoltage, Limits::any());
  for (base::Settings& weight : settings.tables("weight")) {
    const auto voltage = [&weight](const char* key) {
      return weight.quantity_if_given(key, Dimension::kVoltage, Limits::any()).value_or(std::nan(""));
    };
    facts.mass_kg.push_back(weight.quantity("mass", Dimension::kMass, Limits::at_least(0.0)));
    facts.force_N.push_back(weight.quantity("force", Dimension::kForce, Limits::at_least(0.0)));
    facts.voltage_V.push_back(weight.quantity("voltage", Dimension::kVoltage, Limits::any()));
    facts.voltage_standard_error_V.push_back(voltage("standard_error"));
    facts.point_residual_V.push_back(voltage("residual"));
    facts.refused.push_back(weight.text("refused", ""));
  }
  if (const base::Result<void> ok = settings.finish(); !ok) return tl::unexpected(ok.error());
  return result;
}

/// The *.toml files of a folder; none if it does not exist.
std::vector<std::filesystem::path> calibrations_in(const std::filesystem::path& folder) {
  std::error_code error;
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator{folder, error}) {
    if (entry.path().extension() == ".toml") files.push_back(entry.path());
  }
  return files;
}

/// Turns an ISO 8601 time in UTC into "20261122T101500Z".
std::string file_stem(const std::string& date) {
  std::string stem;
  for (const char c : date.substr(0, 19)) {
    if (c != '-' && c != ':') stem += c;
  }
  return stem + "Z";
}

}  // namespace

StoredCalibration stored_calibration(const daq::WeighedCalibration& result, std::string date,
                                     std::string expires, std::string certificate) {
  STICKSLIP_EXPECTS(result.fit.load_cell);
  StoredCalibration stored;
  stored.load_cell = *result.fit.load_cell;
  record::CalibrationFacts& facts = stored.facts;
  facts.date = std::move(date);
  facts.expires = std::move(expires);
  facts.certificate = std::move(certificate);
  facts.gain_standard_error_N_per_V = result.fit.gain_standard_error_N_per_V;
  facts.zero_standard_error_V = result.fit.zero_standard_error_V;
  facts.residual_V = result.fit.residual_V;
  facts.hysteresis_V = result.fit.hysteresis_V;
  for (const daq::WeighedPoint& point : result.points) {
    facts.mass_kg.push_back(point.reading.mass_kg);
    facts.force_N.push_back(point.force_N);
    facts.voltage_V.push_back(point.reading.voltage_V);
    facts.voltage_standard_error_V.push_back(point.reading.standard_error_V.value_or(std::nan("")));
    facts.point_residual_V.push_back(point.residual_V);
    facts.refused.push_back(point.refused);
  }
  return stored;
}

std::string calibration_text(const StoredCalibration& calibration) {
  const record::CalibrationFacts& facts = calibration.facts;
  std::string text =
      "# Calibration of a load cell by `stickslip calibrate`. It holds until cell, amplifier or board are\n"
      "# changed. Never change this file: records name its numbers. A new calibration is a new file.\n\n"
      "[calibration]\n";
  text += fmt::format("date = {}\n", toml_string(facts.date));
  if (!facts.expires.empty()) {
    text += fmt::format("expires = {}  # from then on the daemon warns\n", toml_string(facts.expires));
  }
  if (!facts.certificate.empty()) {
    text += fmt::format("certificate = {}  # of the weights\n", toml_string(facts.certificate));
  }
  text += line("gain", calibration.load_cell.gain_N_per_V, "N/V", "force = (voltage - zero) * gain");
  text += line("zero", calibration.load_cell.zero_V, "V", "of the unloaded cell, by the line");
  text += line("gain_standard_error", facts.gain_standard_error_N_per_V, "N/V", "by least squares");
  text += line("zero_standard_error", facts.zero_standard_error_V, "V", "by least squares");
  text += line("residual", facts.residual_V, "V", "standard deviation about the line");
  text += line("hysteresis", facts.hysteresis_V, "V", "falling less rising, about the line");
  text +=
      line("replaced_gain", facts.replaced_gain_N_per_V, "N/V", "in use before; the change was confirmed");
  for (std::size_t i = 0; i < facts.mass_kg.size(); ++i) {
    const auto known = [](double value) {
      return std::isfinite(value) ? std::optional<double>{value} : std::nullopt;
    };
    text += "\n[[weight]]\n";
    text += line("mass", facts.mass_kg[i], "kg", "0: nothing hung");
    text += line("force", facts.force_N[i], "N", "mass times gravity");
    text += line("voltage", facts.voltage_V[i], "V", "mean");
    text += line("standard_error", known(facts.voltage_standard_error_V[i]), "V", "of the mean");
    text += line("residual", known(facts.point_residual_V[i]), "V", "off the line");
    if (!facts.refused[i].empty()) {
      text += fmt::format("refused = {}  # does not count\n", toml_string(facts.refused[i]));
    }
  }
  return text;
}

base::Result<StoredCalibration> parse_calibration(std::string_view text, std::string_view name) {
  base::Result<base::Settings> settings = base::Settings::parse(text, name);
  if (!settings) return tl::unexpected(settings.error());
  return calibration_of(*settings);
}

bool holds_calibration(const std::filesystem::path& folder) { return !calibrations_in(folder).empty(); }

base::Result<StoredCalibration> load_calibration(const std::filesystem::path& path) {
  std::error_code error;
  std::vector<std::filesystem::path> files;
  if (std::filesystem::is_directory(path, error)) {
    files = calibrations_in(path);
    if (files.empty()) {
      return base::usage_error("{}: holds no calibration: make one with stickslip calibrate", path.string());
    }
  } else {
    files.push_back(path);
  }
  std::optional<StoredCalibration> latest;
  for (const std::filesystem::path& file : files) {
    base::Result<base::Settings> settings = base::Settings::load(file);
    if (!settings) return tl::unexpected(settings.error());
    base::Result<StoredCalibration> one = calibration_of(*settings);
    if (!one) return tl::unexpected(one.error());
    // Dates are UTC of equal length: they order as texts.
    if (!latest || one->facts.date > latest->facts.date) latest = *std::move(one);
  }
  return *std::move(latest);
}

base::Result<std::filesystem::path> keep_calibration(const std::filesystem::path& folder,
                                                     const StoredCalibration& calibration) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) return base::failure("{}: cannot be made: {}", folder.string(), error.message());
  std::filesystem::path file = folder / (file_stem(calibration.facts.date) + ".toml");
  if (auto written = write_new_file(file, calibration_text(calibration)); !written) {
    return tl::unexpected(written.error());
  }
  return file;
}

base::Result<KeptCalibration> keep_result(const daq::WeighedCalibration& result,
                                          const CalibrationPaper& paper, const std::filesystem::path& folder,
                                          std::int64_t now_ns,
                                          const std::optional<daq::GainChange>& confirmed) {
  constexpr double kNanosecondsPerDay = 86'400e9;
  const auto valid_ns = static_cast<std::int64_t>(paper.valid_days * kNanosecondsPerDay);
  KeptCalibration kept{stored_calibration(result, record::iso_time(now_ns),
                                          valid_ns > 0 ? record::iso_time(now_ns + valid_ns) : std::string{},
                                          paper.certificate),
                       {},
                       std::nullopt};
  if (confirmed) kept.stored.facts.replaced_gain_N_per_V = confirmed->in_use_N_per_V;
  std::error_code error;
  if (std::filesystem::is_directory(folder, error) && !std::filesystem::is_empty(folder, error)) {
    auto before = load_calibration(folder);
    if (!before) return tl::unexpected(before.error());
    kept.before = *std::move(before);
  }
  auto file = keep_calibration(folder, kept.stored);
  if (!file) return tl::unexpected(file.error());
  kept.file = *std::move(file);
  return kept;
}

bool expired(const record::CalibrationFacts& facts, std::string_view now) {
  return !facts.expires.empty() && now >= facts.expires;
}

}  // namespace stickslip::io
