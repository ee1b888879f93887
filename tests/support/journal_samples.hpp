/// \file
/// A record written as the storage thread would.
#pragma once

#include <gtest/gtest.h>

#include "core/record/journal.hpp"

namespace stickslip::test {

/// Writes every entry of `record` in the order of a test; its end only if `with_end`.
/// \return sizes of the file after each entry, the header's first.
inline std::vector<std::uint64_t> write_journal(const std::filesystem::path& path,
                                                const record::Record& record, bool with_end = true) {
  auto journal = record::JournalWriter::create(path, record.header);
  EXPECT_TRUE(journal) << (journal ? "" : journal.error().message);
  if (!journal) return {};
  std::vector<std::uint64_t> sizes{journal->size()};
  const auto wrote = [&](const base::Result<void>& result) {
    EXPECT_TRUE(result) << (result ? "" : result.error().message);
    sizes.push_back(journal->size());
  };
  for (const auto& anchor : record.anchors) wrote(journal->append_anchor(anchor));
  for (std::size_t begin = 0; begin < record.raw.size();) {
    std::size_t end = begin + 1;
    while (end < record.raw.size() && end - begin < 7 && record.scan[end] == record.scan[end - 1] + 1) ++end;
    wrote(journal->append_scans(record.scan[begin], std::span{record.raw}.subspan(begin, end - begin),
                                {static_cast<std::int64_t>(begin), 0}));
    if (!record.second.empty()) {
      wrote(journal->append_second(record.scan[begin], std::span{record.second}.subspan(begin, end - begin)));
    }
    if (!record.true_coefficient.empty()) {
      wrote(journal->append_true_coefficients(
          record.scan[begin], std::span{record.true_coefficient}.subspan(begin, end - begin)));
    }
    begin = end;
  }
  for (const auto& gap : record.gaps) wrote(journal->append_gap(gap));
  for (const auto& cycle : record.cycles) wrote(journal->append_cycle(cycle));
  for (const auto& event : record.events) wrote(journal->append_event(event));
  wrote(journal->append_spikes(record.spikes));
  if (with_end) {
    record::EndRecord end = *record.end;
    end.cycles = record.cycles;
    end.spikes = record.spikes;
    wrote(journal->append_end(end));
  }
  EXPECT_TRUE(journal->sync());
  return sizes;
}

}  // namespace stickslip::test
