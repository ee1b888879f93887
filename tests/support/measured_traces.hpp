/// \file
/// Traces of a real tester, paper on paper. They lie beside the project (STICKSLIP_SHARED_DATA names another
/// place) and are required if CI=true.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

namespace stickslip::test {

/// The source of the traces says so; their t_s column too.
inline constexpr double kMeasuredScanRate_Hz = 2000.0;

/// Nearly sinusoidal; saw-tooth; irregular sliding.
inline constexpr const char* kNearlySinusoidal = "paper_k1002_v4300.csv";
inline constexpr const char* kSawTooth = "paper_k168_v42.csv";
inline constexpr const char* kIrregularSliding = "paper_k2254_v42.csv";

[[nodiscard]] inline std::filesystem::path measured_traces_folder() {
  const char* named = std::getenv("STICKSLIP_SHARED_DATA");
  if (named != nullptr && *named != '\0') return named;
  return std::filesystem::path(STICKSLIP_SOURCE_DIR) / ".." / "shared" / "data";
}

[[nodiscard]] inline bool measured_traces_required() {
  const char* ci = std::getenv("CI");
  return ci != nullptr && std::string{ci} == "true";
}

/// The coefficient of each scan; empty if the file is absent.
[[nodiscard]] inline std::vector<double> measured_trace(const std::string& name) {
  std::ifstream stream{measured_traces_folder() / name};
  std::vector<double> values;
  std::string line;
  std::getline(stream, line);  // names of the columns
  while (std::getline(stream, line)) values.push_back(std::stod(line.substr(line.find(',') + 1)));
  return values;
}

}  // namespace stickslip::test
