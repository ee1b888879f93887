#include "daemon/fleet/outbox.hpp"

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <sstream>
#include <system_error>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/record/file.hpp"
#include "daemon/new_file.hpp"

namespace stickslip::daemon {
namespace {

constexpr const char* kExtension = ".json";
constexpr char kMark = '_';  ///< Between the name of the record and its id; in neither of them.

std::string whole_text(const std::filesystem::path& file) {
  std::ostringstream text;
  text << std::ifstream{file}.rdbuf();
  return text.str();
}

/// The result in a file; nothing if this is none of ours.
std::optional<FleetResult> read_result(const std::filesystem::path& file) {
  const std::string stem = file.stem().string();
  const std::size_t mark = stem.rfind(kMark);
  if (file.extension() != kExtension || mark == std::string::npos) return std::nullopt;
  FleetResult result{stem.substr(0, mark), stem.substr(mark + 1), whole_text(file)};
  if (!nlohmann::json::accept(result.payload)) return std::nullopt;
  return result;
}

}  // namespace

Outbox::Outbox(std::filesystem::path folder, std::size_t most) : folder_(std::move(folder)), most_(most) {
  // Where it fails each result is refused as well, and counted.
  static_cast<void>(record::make_folders(folder_));
  load();
}

std::filesystem::path Outbox::path_of(const FleetResult& result) const {
  return folder_ / (result.record + kMark + result.id + kExtension);
}

void Outbox::load() {
  std::vector<std::filesystem::path> files;
  std::error_code error;
  for (std::filesystem::directory_iterator at{folder_, error}, end; !error && at != end; at.increment(error))
    files.push_back(at->path());
  std::sort(files.begin(), files.end());
  for (const std::filesystem::path& file : files) {
    if (auto result = read_result(file)) results_.push_back(*std::move(result));
  }
  std::ifstream{folder_ / "newest"} >> newest_;
  while (results_.size() > most_) forget(0);
}

void Outbox::set_newest(const std::string& record) {
  if (record <= newest_) return;
  newest_ = record;
  const std::filesystem::path part = folder_ / "newest.part";
  std::ofstream{part} << record << '\n';
  // Durable or not: an old name only makes the next program look at more records.
  if (record::sync_path(part)) std::rename(part.c_str(), (folder_ / "newest").c_str());
}

Outbox::Added Outbox::add(FleetResult result) {
  if (std::any_of(results_.begin(), results_.end(),
                  [&result](const FleetResult& other) { return other.id == result.id; })) {
    return {};
  }
  const std::string record = result.record;
  results_.push_back(std::move(result));
  ++unsaved_;
  const bool dropped = results_.size() > most_;
  if (dropped) forget(0);
  save();
  if (unsaved_ == 0) set_newest(record);
  return {true, dropped};
}

void Outbox::save() {
  while (unsaved_ > 0) {
    const FleetResult& first = results_[results_.size() - unsaved_];
    if (!write_new_file(path_of(first), first.payload)) return;
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
  const std::string record = found->record;
  forget(static_cast<std::size_t>(found - results_.begin()));
  set_newest(record);
  return true;
}

}  // namespace stickslip::daemon
