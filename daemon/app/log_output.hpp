/// \file
/// Output of the log: the systemd journal, with fields to filter by, or stderr.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "io/config.hpp"

namespace stickslip::app {

/// One line of the log with its fields.
struct LogEntry {
  io::LogLevel level = io::LogLevel::kInfo;
  /// Identifier of the kind of line; stable between releases.
  std::string_view event{};
  std::string message{};
  std::optional<std::int64_t> test{};        ///< Number of the test concerned.
  std::string record{};                      ///< Path of the record or journal concerned; may be empty.
  std::string_view state{};                  ///< New `state` of the status; may be empty.
  std::string_view cause{};                  ///< Of a gap or of the end of a test; code of a finding.
  std::optional<std::int64_t> first_scan{};  ///< First missing scan of a gap.
  std::optional<std::int64_t> scan_count{};  ///< Missing in a gap.
};

/// Thread-safe.
class LogOutput {
 public:
  virtual ~LogOutput() = default;
  virtual void write(const LogEntry& entry) = 0;
};

/// \param journal_stream  content of the environment variable JOURNAL_STREAM, or null.
/// \return true if the descriptor is the stream to the journal that the variable names [systemd.exec(5)].
[[nodiscard]] bool leads_to_journal(int descriptor, const char* journal_stream);

/// The entry as fields "NAME=value" for sd_journal_sendv(3): MESSAGE, PRIORITY, SYSLOG_IDENTIFIER, and those
/// of STICKSLIP_EVENT, _TEST, _RECORD (absolute), _STATE, _CAUSE, _FIRST_SCAN, _SCAN_COUNT that the entry
/// has.
[[nodiscard]] std::vector<std::string> journal_fields(const LogEntry& entry);

/// The journal if stderr is connected to it; else stderr, with time and level.
[[nodiscard]] std::unique_ptr<LogOutput> make_log_output();

}  // namespace stickslip::app
