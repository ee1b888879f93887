#include "daemon/app/log_output.hpp"

#include <fmt/format.h>
#include <spdlog/pattern_formatter.h>
#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>
#include <sys/stat.h>
#include <sys/uio.h>
#include <syslog.h>
#include <unistd.h>

// Otherwise each entry would name this file as its origin, which is useless.
#define SD_JOURNAL_SUPPRESS_LOCATION
#include <systemd/sd-journal.h>

#include <cstdlib>
#include <filesystem>
#include <system_error>

namespace stickslip::app {
namespace {

spdlog::level::level_enum to_spdlog(io::LogLevel level) {
  switch (level) {
    case io::LogLevel::kDebug:
      return spdlog::level::debug;
    case io::LogLevel::kInfo:
      return spdlog::level::info;
    case io::LogLevel::kWarning:
      return spdlog::level::warn;
    case io::LogLevel::kError:
      return spdlog::level::err;
  }
  return spdlog::level::info;
}

int priority_of(io::LogLevel level) {
  switch (level) {
    case io::LogLevel::kDebug:
      return LOG_DEBUG;
    case io::LogLevel::kInfo:
      return LOG_INFO;
    case io::LogLevel::kWarning:
      return LOG_WARNING;
    case io::LogLevel::kError:
      return LOG_ERR;
  }
  return LOG_INFO;
}

std::string absolute(const std::string& path) {
  std::error_code error;
  const std::filesystem::path found = std::filesystem::absolute(path, error);
  return error ? path : found.lexically_normal().string();
}

class Stderr final : public LogOutput {
 public:
  Stderr() : logger_("stickslipd", std::make_shared<spdlog::sinks::stderr_sink_mt>()) {
    logger_.set_pattern("%H:%M:%S.%e %l: %v");
    logger_.set_level(spdlog::level::trace);
    logger_.flush_on(spdlog::level::trace);
  }
  void write(const LogEntry& entry) override {
    logger_.log(to_spdlog(entry.level), spdlog::string_view_t{entry.message});
  }

 private:
  spdlog::logger logger_;
};

class Journal final : public LogOutput {
 public:
  void write(const LogEntry& entry) override {
    std::vector<std::string> fields = journal_fields(entry);
    std::vector<iovec> parts;
    parts.reserve(fields.size());
    for (std::string& field : fields) parts.push_back({field.data(), field.size()});
    // Without its socket nothing is sent, and that is no error [sd_journal_sendv(3)].
    if (::access("/run/systemd/journal/socket", F_OK) == 0 &&
        ::sd_journal_sendv(parts.data(), static_cast<int>(parts.size())) == 0)
      return;
    // Its stream takes the text; the level in front is as sd-daemon(3) has it.
    fmt::print(stderr, "<{}>{}\n", priority_of(entry.level), entry.message);
  }
};

}  // namespace

bool leads_to_journal(int descriptor, const char* journal_stream) {
  struct stat file {};
  return journal_stream != nullptr && ::fstat(descriptor, &file) == 0 &&
         fmt::format("{}:{}", file.st_dev, file.st_ino) == journal_stream;
}

std::vector<std::string> journal_fields(const LogEntry& entry) {
  std::vector<std::string> fields{
      fmt::format("MESSAGE={}", entry.message),
      fmt::format("PRIORITY={}", priority_of(entry.level)),
      "SYSLOG_IDENTIFIER=stickslipd",
      fmt::format("STICKSLIP_EVENT={}", entry.event),
  };
  const auto add_text = [&fields](std::string_view name, std::string_view value) {
    if (!value.empty()) fields.push_back(fmt::format("STICKSLIP_{}={}", name, value));
  };
  const auto add_number = [&fields](std::string_view name, const std::optional<std::int64_t>& value) {
    if (value) fields.push_back(fmt::format("STICKSLIP_{}={}", name, *value));
  };
  add_number("TEST", entry.test);
  if (!entry.record.empty()) add_text("RECORD", absolute(entry.record));
  add_text("STATE", entry.state);
  add_text("CAUSE", entry.cause);
  add_number("FIRST_SCAN", entry.first_scan);
  add_number("SCAN_COUNT", entry.scan_count);
  return fields;
}

std::unique_ptr<LogOutput> make_log_output() {
  if (leads_to_journal(STDERR_FILENO, std::getenv("JOURNAL_STREAM"))) return std::make_unique<Journal>();
  return std::make_unique<Stderr>();
}

}  // namespace stickslip::app
