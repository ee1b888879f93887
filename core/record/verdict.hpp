/// \file
/// Verdict about a record or journal: complete, incomplete or damaged, with findings.
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

/// The judgement about a file: of a record or journal, by the worst of its findings.
enum class Judgement {
  kComplete,  ///< A finished record: everything is there and agrees with everything else.
  /// Undamaged, but data are missing or not reliable: a gap, a status other than complete, a seal left open,
  /// a record of stickslipd without configuration, clocks that contradict the scan rate; and every journal.
  kIncomplete,
  /// Checksums or contents are inconsistent, or a record is truncated; a journal with a torn end is
  /// kIncomplete.
  kDamaged,
  kNotJudged,  ///< The file does not exist, has an unknown kind or version, or cannot be read now.
};

[[nodiscard]] std::string_view name(Judgement judgement) noexcept;

/// One observation about a file.
struct Finding {
  /// A note does not change the judgement.
  enum class Weight { kNote, kIncomplete, kDamage };

  Weight weight = Weight::kNote;
  /// For people: an object of the file, with a row or byte where it has any; "file" for the whole.
  std::string place;
  std::string text;
};

[[nodiscard]] std::string_view name(Finding::Weight weight) noexcept;

/// The judgement about a file, with what led to it. A member that is unknown is absent or empty.
struct Verdict {
  Judgement judgement = Judgement::kNotJudged;
  /// "record" or "journal"; empty if the judgement is kNotJudged, or if the file ended the process that
  /// judged it.
  std::string kind;
  std::optional<std::int64_t> format_version;
  std::optional<std::int64_t> scans_present;  ///< Number of scans that could be read.
  /// Number of scans that a record says were written; absent also if its raw values could not be judged.
  std::optional<std::int64_t> scans_committed;
  std::string status;  ///< Name of the Status that the file states.
  std::vector<daq::Gap> gaps;
  /// Checksum of the raw values stored in a record; empty also if they could not be judged.
  std::string sha256_stored;
  std::string sha256_found;  ///< Checksum computed from the raw values of a record.
  std::vector<Finding> findings;

  // Each adds a finding; both texts may quote the file and are made printable.

  void note(std::string_view place, std::string_view text) { add(Finding::Weight::kNote, place, text); }
  void incomplete(std::string_view place, std::string_view text) {
    add(Finding::Weight::kIncomplete, place, text);
  }
  void damage(std::string_view place, std::string_view text) { add(Finding::Weight::kDamage, place, text); }

 private:
  void add(Finding::Weight weight, std::string_view place, std::string_view text) {
    findings.push_back({weight, base::one_line(place, place.size()), base::one_line(text, text.size())});
  }
};

/// Judges any file: reads every byte of a record and every entry of a journal. A malicious file may crash
/// HDF5, so judge untrusted files in a separate process (io/verify.hpp). Throws only std::bad_alloc; memory
/// that lacks while a record is judged may also become a finding of damage.
/// \param calls  for tests; the entries of a journal are read by the system's.
[[nodiscard]] Verdict judge(const std::filesystem::path& path, const FileCalls& calls = system_calls());

}  // namespace stickslip::record
