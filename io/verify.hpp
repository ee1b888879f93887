/// \file
/// Verifies records and journals. Each file is read in a process of its own, so that a damaged file cannot
/// end this one.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "core/record/verdict.hpp"

namespace stickslip::io {

struct VerifyOutput {
  std::string text;
  int exit_status = 0;
};

/// Exit statuses. That of several files is the worst one; from the worst: 3, 4, 1, 0.
inline constexpr int kAllComplete = 0;
inline constexpr int kSomeIncomplete = 1;
inline constexpr int kSomeDamaged = 3;
inline constexpr int kSomeNotJudged = 4;

/// One verdict as JSON, with the names of docs/reliability.md. \param file  the path as the user gave it.
[[nodiscard]] nlohmann::ordered_json verdict_json(const std::string& file, const record::Verdict& verdict);

/// Verifies the files one after the other; blocks. Call it only while this process has one thread. \param
/// json  the text is {"files": [...]} instead of lines.
[[nodiscard]] VerifyOutput verify_files(const std::vector<std::string>& files, bool json);

}  // namespace stickslip::io
