#include "core/record/journal_name.hpp"

#include <fmt/format.h>

#include "core/record/finaliser.hpp"
#include "core/record/journal.hpp"

namespace stickslip::record {
namespace {

/// A link that leads nowhere stands there too.
bool stands(const std::filesystem::path& path) {
  std::error_code ignored;
  return std::filesystem::exists(std::filesystem::symlink_status(path, ignored));
}

}  // namespace

std::filesystem::path free_journal_path(const std::filesystem::path& wanted,
                                        const std::filesystem::path& taken) {
  for (int attempt = 1;; ++attempt) {
    std::filesystem::path journal = wanted;
    if (attempt > 1) {
      journal.replace_filename(
          fmt::format("{}-{}{}", wanted.stem().string(), attempt, wanted.extension().string()));
    }
    if (!stands(journal) && !stands(record_of(journal)) && journal != taken) return journal;
  }
}

}  // namespace stickslip::record
