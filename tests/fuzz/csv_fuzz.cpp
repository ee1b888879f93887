// Any file becomes records or is refused in one line; a record has as many scans as values, and its indices
// rise.

#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <functional>
#include <string>

#include "io/traces/import.hpp"

#include "core/base/contract.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace stickslip;
  static const int file = ::memfd_create("trace.csv", MFD_CLOEXEC);
  STICKSLIP_EXPECTS(::ftruncate(file, 0) == 0 && ::pwrite(file, data, size, 0) == static_cast<ssize_t>(size));
  traces::ImportRequest request;
  request.path = "/proc/self/fd/" + std::to_string(file);
  // The first byte says what the user states.
  const unsigned options = size == 0 ? 0 : data[0];
  request.column = (options & 1U) != 0 ? "force" : "2";
  request.unit = "N";
  request.tester.sled_mass_kg = 2.331;
  if ((options & 2U) != 0) request.rate_Hz = 350.0;
  request.invert = (options & 4U) != 0;
  request.reverse = (options & 8U) != 0;
  request.resample = (options & 16U) != 0;
  request.skip_doubled = (options & 32U) != 0;
  if ((options & 64U) != 0) request.dialect.decimal = ',';
  const auto imported = traces::import_trace(request);
  STICKSLIP_EXPECTS(imported || imported.error().message.find('\n') == std::string::npos);
  STICKSLIP_EXPECTS(!imported || !imported->tests.empty());
  if (imported) {
    for (const traces::ImportedTest& test : imported->tests) {
      STICKSLIP_EXPECTS(test.scans.size() > 0 && test.record.end);
      base::ScanIndex next = 0;
      test.scans.for_each_piece([&next](const record::ScanPiece& piece) {
        for (const base::ScanIndex scan : piece.scan) {
          STICKSLIP_EXPECTS(scan >= next);
          next = scan + 1;
        }
      });
    }
  }
  const auto inspected = traces::inspect(request);
  STICKSLIP_EXPECTS(inspected || inspected.error().message.find('\n') == std::string::npos);
  return 0;
}
