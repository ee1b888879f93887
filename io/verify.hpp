/// \file
/// Verdicts on files, safe from the files: each is judged in a process of its own.
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

/// Exit statuses, the worst of all files: 3 before 4 before 1.
inline constexpr int kAllComplete = 0;
inline constexpr int kSomeIncomplete = 1;
inline constexpr int kSomeDamaged = 3;
inline constexpr int kSomeNotJudged = 4;

/// One verdict with the names of docs/reliability.md. \param file  as it was given.
[[nodiscard]] nlohmann::ordered_json verdict_json(const std::string& file, const record::Verdict& verdict);

/// Only while this process has one thread. \param json  {"files": [...]} instead of lines.
[[nodiscard]] VerifyOutput verify_files(const std::vector<std::string>& files, bool json);

}  // namespace stickslip::io
