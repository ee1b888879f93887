/// \file
/// What is to be said of a file that ought to hold a test: complete or not, and why.
///
///     const Verdict verdict = judge(path);
///     if (verdict.judgement == Judgement::kDamaged) for (const Finding& finding : verdict.findings) …
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/wording.hpp"
#include "core/daq/gap.hpp"
#include "core/record/file_calls.hpp"

namespace stickslip::record {

enum class Judgement {
  kComplete,    ///< A finished record: everything is there and agrees with everything else.
  kIncomplete,  ///< Sound, but something is missing for a reason that it says.
  kDamaged,     ///< It contradicts its checksums or itself, or is cut short.
  kNotJudged,   ///< No file, none of a kind and version that this program reads, or it cannot be looked at.
};

[[nodiscard]] std::string_view name(Judgement judgement) noexcept;

struct Finding {
  enum class Weight { kNote, kIncomplete, kDamage };

  Weight weight = Weight::kNote;
  std::string place;  ///< Object of the file, with rows where it has any; "file" for the whole.
  std::string text;
};

[[nodiscard]] std::string_view name(Finding::Weight weight) noexcept;

struct Verdict {
  Judgement judgement = Judgement::kNotJudged;
  std::string kind;  ///< "record" or "journal"; empty if it is neither.
  std::optional<std::int64_t> format_version;
  std::optional<std::int64_t> scans_present;
  std::optional<std::int64_t> scans_committed;  ///< As the finaliser counted them.
  std::string status;                           ///< As the file says it.
  std::vector<daq::Gap> gaps;
  std::string sha256_stored;  ///< Of the raw values,
  std::string sha256_found;   ///< and of those that stand there.
  std::vector<Finding> findings;

  void note(std::string_view place, std::string_view text) { add(Finding::Weight::kNote, place, text); }
  void incomplete(std::string_view place, std::string_view text) {
    add(Finding::Weight::kIncomplete, place, text);
  }
  void damage(std::string_view place, std::string_view text) { add(Finding::Weight::kDamage, place, text); }

 private:
  /// Both may cite what stands in the file.
  void add(Finding::Weight weight, std::string_view place, std::string_view text) {
    findings.push_back({weight, base::one_line(place, place.size()), base::one_line(text, text.size())});
  }
};

/// Any file: reads every byte of a record and every entry of a journal. A file made to deceive HDF5 may still
/// end the process; who judges strangers' files does so in a process of its own (io/verify.hpp). Throws
/// only std::bad_alloc.
[[nodiscard]] Verdict judge(const std::filesystem::path& path, const FileCalls& calls = system_calls());

}  // namespace stickslip::record
