/// \file
/// Where lines of the log go: to the journal with fields to filter by, or to stderr for people.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "io/config.hpp"

namespace stickslip::app {

/// One line, and what it is about.
struct LogEntry {
  io::LogLevel level = io::LogLevel::kInfo;
  std::string_view event{};  ///< A word for its kind, from one release to the next the same.
  std::string message{};
  std::optional<std::int64_t> test{};  ///< Number of the test that it is about.
  std::string record{};                ///< Path of the record or journal that it is about; may be empty.
  std::string_view state{};            ///< `state` of the status from here on; may be empty.
  std::string_view cause{};            ///< Of a gap, or of the end of a test; may be empty.
  std::optional<std::int64_t> first_scan{};  ///< Of a gap.
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

/// "NAME=value" each, as sd_journal_sendv(3) takes them: MESSAGE, PRIORITY, SYSLOG_IDENTIFIER, and those of
/// STICKSLIP_EVENT, _TEST, _RECORD (absolute), _STATE, _CAUSE, _FIRST_SCAN, _SCAN_COUNT that the entry has.
[[nodiscard]] std::vector<std::string> journal_fields(const LogEntry& entry);

/// The journal where stderr leads there; else stderr, with time and level for people.
[[nodiscard]] std::unique_ptr<LogOutput> make_log_output();

}  // namespace stickslip::app
