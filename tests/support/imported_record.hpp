/// \file
/// The record of an imported test with its scans in memory.
#pragma once

#include "io/traces/import.hpp"

namespace stickslip::test {

inline record::Record in_memory(const traces::ImportedTest& test) {
  record::Record record = test.record;
  record.scan.assign(test.scans.scan.begin(), test.scans.scan.end());
  record.raw.assign(test.scans.raw.begin(), test.scans.raw.end());
  record.second.assign(test.scans.second.begin(), test.scans.second.end());
  return record;
}

}  // namespace stickslip::test
