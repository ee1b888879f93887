#include "cli/bundle_parts.hpp"

#include <fmt/format.h>
#include <sys/utsname.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstdint>
#include <string_view>
#include <system_error>
#include <utility>

#include "cli/record_json.hpp"
#include "io/calibration_file.hpp"
#include "io/child_process.hpp"
#include "io/dated_folders.hpp"
#include "io/json_text.hpp"
#include "io/own_records.hpp"
#include "io/table.hpp"
#include <nlohmann/json.hpp>

#include "core/base/regular_file.hpp"
#include "core/base/settings.hpp"
#include "core/base/text.hpp"
#include "core/record/finaliser.hpp"
#include "core/record/read_apart.hpp"
#include "daemon/client/client.hpp"

namespace stickslip::cli::bundle {
namespace {

using Json = nlohmann::ordered_json;

/// Longest wait for the daemon and for each program that is asked.
constexpr std::chrono::milliseconds kTimeout{5000};
constexpr std::size_t kLargestNamedFile = 64 << 10;
constexpr std::size_t kLargestLog = 256 << 10;
constexpr const char* kLogLines = "500";
/// Keys of the configuration whose files hold a secret. Relative names are of the configuration's folder,
/// those of control.token_file of the working directory.
constexpr std::string_view kSecretFiles[] = {"fleet.password_file", "fleet.key_file", "control.token_file"};
/// Files that tell of trouble, by name.
constexpr std::size_t kMostNames = 50;

std::string not_had(std::string_view why) { return fmt::format("missing: {}\n", why); }

/// Output of a program, or why there is none.
std::string told_by(const std::string& program, std::vector<std::string> arguments) {
  const auto answer = io::ask_program(program, std::move(arguments), {}, kTimeout);
  if (!answer) return not_had(answer.error().message);
  if (!*answer) return not_had(fmt::format("there is no program {}", program));
  std::string text = (*answer)->output + (*answer)->errors;
  if ((*answer)->status != 0) text += not_had(fmt::format("{} ended with {}", program, (*answer)->status));
  return text;
}

bool is_secret(const Named& named, const std::filesystem::path& file) {
  return std::ranges::any_of(named.secret_files, [&](const std::filesystem::path& secret) {
    std::error_code error;
    return std::filesystem::equivalent(secret, file, error);
  });
}

/// A TOML file; others are not shown, as they may be anything.
std::string toml_text(const std::filesystem::path& file, const Redaction& redaction) {
  const base::Result<std::string> text = base::read_text(file, kLargestNamedFile + 1);
  if (!text) return not_had(text.error().message);
  if (text->size() > kLargestNamedFile)
    return not_had(fmt::format("it is longer than {} bytes", kLargestNamedFile));
  if (const auto settings = base::Settings::parse(*text, file.string()); !settings)
    return redaction.lines(not_had(settings.error().message));
  return redaction.toml(*text);
}

std::string calibration_text_of(const std::filesystem::path& path, const Redaction& redaction) {
  const auto stored = io::load_calibration(path);
  return stored ? redaction.toml(io::calibration_text(*stored))
                : redaction.lines(not_had(stored.error().message));
}

/// The last bytes of a file, from the beginning of a line.
base::Result<std::string> end_of(const std::filesystem::path& file, std::size_t most) {
  const base::Result<base::RegularFile> opened = base::open_regular(file);
  if (!opened) return tl::unexpected(opened.error());
  const std::uint64_t first = opened->size > most ? opened->size - most : 0;
  std::string text(opened->size - first, '\0');
  const ssize_t got = ::pread(opened->file.get(), text.data(), text.size(), static_cast<off_t>(first));
  if (got < 0)
    return base::failure("{}: cannot be read: {}", file.string(), std::generic_category().message(errno));
  text.resize(static_cast<std::size_t>(got));
  if (first > 0) text.erase(0, std::min(text.find('\n'), text.size() - 1) + 1);
  return text;
}

}  // namespace

Named named_in(const std::filesystem::path& file) {
  Named named{.record_folder = "records", .socket = "/run/stickslip/control.sock"};
  base::Result<base::Settings> settings = base::Settings::load(file);
  if (!settings) {
    named.unread = settings.error().message;
    return named;
  }
  const std::filesystem::path folder = file.parent_path();
  const auto value = [&](const std::string& key, const std::string& fallback) {
    const std::size_t dot = key.find('.');
    return settings->table(key.substr(0, dot)).text(key.substr(dot + 1), fallback);
  };
  const auto beside = [&](const std::string& key) {
    const std::string name = value(key, "");
    return name.empty() ? std::filesystem::path{} : folder / name;
  };
  named.record_folder = value("record.folder", "records");
  named.socket = value("control.socket", "");
  named.method = beside("method.file");
  named.characterisation = beside("tester.characterisation");
  named.calibration = beside("tester.calibration");
  for (const std::string_view key : kSecretFiles) {
    const std::string name{key};
    named.secret_files.push_back(name == "control.token_file" ? std::filesystem::path{value(name, "")}
                                                              : beside(name));
  }
  return named;
}

std::string configuration_text(const std::filesystem::path& file, const Redaction& redaction) {
  const base::Result<std::string> text = base::read_text(file, base::Settings::kLargestFile);
  if (!text) return not_had(text.error().message);
  if (!base::is_utf8(*text)) return not_had(file.string() + ": is no text in UTF-8");
  return redaction.configuration(*text);
}

std::string named_files_text(const Named& named, const Redaction& redaction) {
  if (!named.unread.empty())
    return redaction.lines(not_had("the configuration cannot be read: " + named.unread));
  std::string text;
  for (const auto& [what, file, read] : {std::tuple{"method", &named.method, &toml_text},
                                         {"characterisation", &named.characterisation, &toml_text},
                                         {"calibration", &named.calibration, &calibration_text_of}}) {
    text += redaction.lines(
        fmt::format("-- {}: {}\n", what, file->empty() ? "none is named" : base::printable(file->string())));
    if (file->empty()) continue;
    text += is_secret(named, *file) ? not_had("the configuration names it for a secret, too")
                                    : (*read)(*file, redaction);
  }
  return text;
}

std::string system_text(const Named& named) {
  utsname kernel{};
  ::uname(&kernel);
  std::string text =
      fmt::format("{} {} {} {}\n", kernel.sysname, kernel.release, kernel.version, kernel.machine);
  const base::Result<std::string> release = base::read_text("/etc/os-release", kLargestNamedFile);
  text += release ? *release : not_had(release.error().message);
  text += "-- service\n";
  text +=
      told_by("systemctl", {"show", "stickslipd", "--property",
                            "LoadState,UnitFileState,ActiveState,SubState,Result,NRestarts,ExecMainStatus,"
                            "StateChangeTimestamp"});
  text += "-- room at " + named.record_folder.string() + "\n";
  return text + told_by("df", {"-PTh", "--", named.record_folder.string()});
}

std::string status_text(const Named& named, const Redaction& redaction) {
  if (named.socket.empty()) return not_had("the configuration names no [control] socket");
  const auto reply = client::request(named.socket, {"GET", "/v1/status", {}, {}, {}}, kTimeout);
  if (!reply) return not_had(reply.error().message);
  const Json status = Json::parse(reply->body, nullptr, false);
  if (reply->status != 200 || !status.is_object())
    return not_had(fmt::format("{}: no status but {}", named.socket.string(), reply->status));
  return io::json_document(redaction.json(status));
}

std::string log_text(const std::filesystem::path& file) {
  if (file.empty()) {
    return told_by("journalctl", {"--unit", "stickslipd", "--lines", kLogLines, "--no-pager", "--no-hostname",
                                  "--output", "short-iso", "--utc"}) +
           "If the daemon logs to a file, name it: --log FILE\n";
  }
  const base::Result<std::string> text = end_of(file, kLargestLog);
  return text ? *text : not_had(text.error().message);
}

std::string folder_text(const Named& named) {
  struct Kind {
    std::string_view what;
    std::string_view ending;
    bool tells_of_trouble;
    std::vector<std::string> files{};
    std::uintmax_t size = 0;
  };
  std::array<Kind, 5> kinds{{{"records", ".h5", false},
                             {"journals", ".journal", true},
                             {"damaged journals", record::kDamagedExtension, true},
                             {"unfinished files", ".part", true},
                             {"others", "", false}}};
  std::error_code error;
  if (!std::filesystem::exists(named.record_folder, error))
    return not_had(error ? error.message() : "there is no such folder");
  const io::FilesFound found = io::find_files(named.record_folder, [](const auto&) { return true; });
  for (const std::string& file : found.files) {
    Kind& kind = *std::ranges::find_if(kinds, [&](const Kind& one) { return file.ends_with(one.ending); });
    const std::uintmax_t size = std::filesystem::file_size(file, error);
    if (!error) kind.size += size;
    kind.files.push_back(file);
  }
  std::string text;
  for (const Kind& kind : kinds) {
    text += fmt::format("{} {}, {} bytes\n", kind.files.size(), kind.what, kind.size);
    if (!kind.tells_of_trouble) continue;
    for (std::size_t i = 0; i < std::min(kind.files.size(), kMostNames); ++i)
      text +=
          fmt::format("  {}, {} bytes\n", kind.files[i], std::filesystem::file_size(kind.files[i], error));
    if (kind.files.size() > kMostNames)
      text += fmt::format("  and {} more\n", kind.files.size() - kMostNames);
  }
  for (const io::UnreadFolder& folder : found.unread)
    text += fmt::format("{}: {}", folder.folder.string(), not_had(folder.why));
  return text;
}

std::string records_text(const Named& named, int most, const Redaction& redaction) {
  std::vector<std::filesystem::path> records = io::own_records(named.record_folder);
  if (records.empty()) return not_had("the daemon made none there, or the folder cannot be listed");
  io::keep_last(records, static_cast<std::size_t>(most));
  std::string text;
  for (const std::filesystem::path& file : records) {
    const base::Result<record::Record> record = record::read_facts_apart(file);
    text += record ? io::json_document(redaction.json(record_json(file.string(), *record)))
                   : not_had(record.error().message);
  }
  return text;
}

}  // namespace stickslip::cli::bundle
