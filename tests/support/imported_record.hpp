/// \file
/// The record of an imported test with its scans in memory.
#pragma once

#include "io/traces/import.hpp"

namespace stickslip::test {

inline record::Record in_memory(const traces::ImportedTest& test) {
  record::Record record = test.record;
  test.scans.for_each_piece([&record](const record::ScanPiece& piece) {
    record.scan.insert(record.scan.end(), piece.scan.begin(), piece.scan.end());
    record.raw.insert(record.raw.end(), piece.raw.begin(), piece.raw.end());
  });
  if (!test.scans.has_second()) return record;
  test.scans.for_each_second_piece([&record](std::span<const std::int32_t> piece) {
    record.second.insert(record.second.end(), piece.begin(), piece.end());
  });
  return record;
}

}  // namespace stickslip::test
