#include "core/record/hdf.hpp"

#include <algorithm>

namespace stickslip::record {
namespace {

/// Called from the outermost error inwards: the last one is the cause.
herr_t keep_reason(unsigned /*depth*/, const H5E_error2_t* error, void* reason) noexcept {
  if (error->desc != nullptr) *static_cast<std::string*>(reason) = error->desc;
  return 0;
}

}  // namespace

void throw_refused(const std::string& what) {
  std::string reason;
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_DOWNWARD, keep_reason, &reason);
  std::replace(reason.begin(), reason.end(), '\n', ' ');
  throw HdfError(what + ": " + (reason.empty() ? "refused by HDF5" : reason));
}

void prepare_hdf5() {
  static const herr_t once = H5dont_atexit();
  check(once, "H5dont_atexit");
  check(H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr), "H5Eset_auto2");
}

}  // namespace stickslip::record
