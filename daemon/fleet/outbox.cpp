#include "daemon/fleet/outbox.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <fstream>
#include <optional>
#include <span>
#include <system_error>
#include <tuple>
#include <unordered_set>
#include <utility>

#include "io/new_file.hpp"
#include <nlohmann/json.hpp>

#include "core/base/regular_file.hpp"
#include "core/record/file.hpp"

namespace stickslip::fleet {
namespace {

constexpr const char* kExtension = ".json";
/// Separates sequence number, name of the record and id, none of which contains it.
constexpr char kMark = '_';
constexpr const char* kTold = "told";
constexpr const char* kNewest = "newest";  ///< File of earlier versions.
/// `told` is shortened when its names of missing records outnumber the others by this.
constexpr std::size_t kFewLines = 1000;

std::string whole_text(const std::filesystem::path& file) {
  return base::read_text(file).value_or(std::string{});
}

/// Reads the result in a file; nothing if it is no file of the outbox. Files of earlier versions have no
/// sequence number; they come first.
std::optional<FleetResult> read_result(const std::filesystem::path& file) {
  const std::string stem = file.stem().string();
  const std::size_t mark = stem.rfind(kMark);
  if (file.extension() != kExtension || mark == std::string::npos) return std::nullopt;
  FleetResult result{stem.substr(0, mark), stem.substr(mark + 1), whole_text(file)};
  if (const std::size_t first = result.record.find(kMark); first != std::string::npos) {
    const char* const digits = result.record.data();
    const auto [stopped, error] = std::from_chars(digits, digits + first, result.sequence);
    if (error != std::errc{} || stopped != digits + first) return std::nullopt;
    result.record.erase(0, first + 1);
  }
  if (!nlohmann::json::accept(result.payload)) return std::nullopt;
  return result;
}

std::unordered_set<std::string> lines_of(const std::filesystem::path& file) {
  std::unordered_set<std::string> lines;
  std::ifstream text{file};
  for (std::string line; std::getline(text, line);) {
    if (!line.empty()) lines.insert(line);
  }
  return lines;
}

}  // namespace

Outbox::Outbox(std::filesystem::path folder, std::size_t most) : folder_(std::move(folder)), most_(most) {
  // Where it fails each result is refused as well, and counted.
  static_cast<void>(record::make_folders(folder_));
  load();
}

std::filesystem::path Outbox::path_of(const FleetResult& result) const {
  const std::string number =
      result.sequence == 0 ? std::string{} : fmt::format("{:012}{}", result.sequence, kMark);
  return folder_ / (number + result.record + kMark + result.id + kExtension);
}

void Outbox::load() {
  std::error_code error;
  for (std::filesystem::directory_iterator at{folder_, error}, end; !error && at != end;
       at.increment(error)) {
    if (auto result = read_result(at->path())) results_.push_back(*std::move(result));
  }
  std::sort(results_.begin(), results_.end(), [](const FleetResult& a, const FleetResult& b) {
    return std::tie(a.sequence, a.record) < std::tie(b.sequence, b.record);
  });
  if (!results_.empty()) next_sequence_ = results_.back().sequence + 1;
  while (results_.size() > most_) forget(0);
}

void Outbox::note_told(std::string_view lines) {
  const record::Descriptor file{::open((folder_ / kTold).c_str(),
                                       O_WRONLY | O_CREAT | O_APPEND | O_NOFOLLOW | O_CLOEXEC,
                                       io::kEverybodyReads)};
  if (!file.open()) return;
  // A line that a power cut has torn must not take the next one with it.
  const std::string text = (::lseek(file.get(), 0, SEEK_END) > 0 ? "\n" : "") + std::string{lines};
  const auto bytes = std::as_bytes(std::span{text});
  if (record::write_all(file.get(), bytes, record::system_calls()) == bytes.size()) {
    static_cast<void>(::fdatasync(file.get()));
  }
}

std::vector<std::filesystem::path> Outbox::untold(std::vector<std::filesystem::path> records,
                                                  const std::string& now) {
  const auto stem = [](const std::filesystem::path& record) { return record.stem().string(); };
  std::error_code error;
  if (std::filesystem::symlink_status(folder_ / kTold, error).type() ==
      std::filesystem::file_type::not_found) {
    std::string newest;
    std::ifstream{folder_ / kNewest} >> newest;
    std::string lines;
    for (const std::filesystem::path& record : records) {
      if (newest.empty() || (newest <= now && stem(record) <= newest)) lines += stem(record) + '\n';
    }
    note_told(lines);
    std::filesystem::remove(folder_ / kNewest, error);
    if (newest.empty()) return {};
  }
  const std::unordered_set<std::string> told = lines_of(folder_ / kTold);
  const auto is_told = [&](const std::filesystem::path& record) { return told.count(stem(record)) > 0; };
  const auto first_told =
      std::stable_partition(records.begin(), records.end(), [&](const auto& one) { return !is_told(one); });
  const auto kept = static_cast<std::size_t>(records.end() - first_told);
  // None of them there: a folder that is away for a moment is no reason to forget.
  if (kept > 0 && told.size() > 2 * kept + kFewLines) {
    std::string lines;
    for (auto record = first_told; record != records.end(); ++record) lines += stem(*record) + '\n';
    const std::filesystem::path fresh = folder_ / "told.new";
    std::filesystem::remove(fresh, error);
    if (io::write_new_file(fresh, lines)) std::filesystem::rename(fresh, folder_ / kTold, error);
  }
  records.erase(first_told, records.end());
  return records;
}

Outbox::Added Outbox::add(FleetResult result) {
  const auto same = std::find_if(results_.begin(), results_.end(),
                                 [&result](const FleetResult& other) { return other.id == result.id; });
  if (same != results_.end()) {
    const auto index = static_cast<std::size_t>(same - results_.begin());
    // A former program was stopped between the result and the note.
    if (index < results_.size() - unsaved_) note_told(same->record + '\n');
    return {};
  }
  result.sequence = next_sequence_++;
  results_.push_back(std::move(result));
  ++unsaved_;
  const bool dropped = results_.size() > most_;
  if (dropped) forget(0);
  save();
  return {true, dropped};
}

void Outbox::save() {
  while (unsaved_ > 0) {
    const FleetResult& first = results_[results_.size() - unsaved_];
    if (!io::write_new_file(path_of(first), first.payload)) return;
    note_told(first.record + '\n');
    --unsaved_;
  }
}

void Outbox::forget(std::size_t index) {
  const bool saved = index < results_.size() - unsaved_;
  std::error_code error;
  if (saved) {
    std::filesystem::remove(path_of(results_[index]), error);
  } else {
    --unsaved_;
  }
  results_.erase(results_.begin() + static_cast<std::ptrdiff_t>(index));
}

bool Outbox::remove(const std::string& id) {
  const auto found = std::find_if(results_.begin(), results_.end(),
                                  [&id](const FleetResult& result) { return result.id == id; });
  if (found == results_.end()) return false;
  const auto index = static_cast<std::size_t>(found - results_.begin());
  if (index >= results_.size() - unsaved_) note_told(found->record + '\n');
  forget(index);
  return true;
}

}  // namespace stickslip::fleet
