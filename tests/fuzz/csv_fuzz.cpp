// Any file is a trace or is refused in one line; a trace has as many scans as values.

#include <sys/mman.h>
#include <unistd.h>

#include <string>

#include "core/base/contract.hpp"
#include "core/record/csv_import.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace stickslip;
  static const int file = ::memfd_create("trace.csv", MFD_CLOEXEC);
  STICKSLIP_EXPECTS(::ftruncate(file, 0) == 0 && ::pwrite(file, data, size, 0) == static_cast<ssize_t>(size));
  record::CsvImportRequest request;
  request.path = "/proc/self/fd/" + std::to_string(file);
  request.column = "force";
  request.rate_Hz = 350.0;
  request.quantity = daq::RawQuantity::kForce_N;
  const auto record = record::read_csv(request);
  STICKSLIP_EXPECTS(record || record.error().message.find('\n') == std::string::npos);
  STICKSLIP_EXPECTS(!record || (record->scan.size() == record->raw.size() && record->end));
  return 0;
}
