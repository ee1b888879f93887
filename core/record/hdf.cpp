#include "core/record/hdf.hpp"

#include <algorithm>
#include <new>

namespace stickslip::record {
namespace {

struct Reason {
  std::string text;
  bool no_memory = false;
};

/// Called from the outermost error inwards: the last one is the cause.
herr_t keep_reason(unsigned /*depth*/, const H5E_error2_t* error, void* kept) noexcept {
  Reason& reason = *static_cast<Reason*>(kept);
  if (error->desc != nullptr) reason.text = error->desc;
  reason.no_memory =
      error->maj_num == H5E_RESOURCE && (error->min_num == H5E_NOSPACE || error->min_num == H5E_CANTALLOC);
  return 0;
}

/// In one line.
std::string innermost_reason() {
  Reason reason;
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_DOWNWARD, keep_reason, &reason);
  // As operator new does, so that a handler that limits memory is informed.
  if (const std::new_handler told = std::get_new_handler(); reason.no_memory && told != nullptr) told();
  std::replace(reason.text.begin(), reason.text.end(), '\n', ' ');
  return reason.text.empty() ? "refused by HDF5" : reason.text;
}

}  // namespace

void throw_refused(const std::string& what) { throw HdfError(what + ": " + innermost_reason()); }

std::string& unclosed() noexcept {
  static thread_local std::string why;
  return why;
}

void note_unclosed() noexcept {
  try {
    unclosed() = innermost_reason();
  } catch (const std::exception&) {
    unclosed() = "no memory";
  }
}

void prepare_hdf5() {
  static const herr_t once = H5dont_atexit();
  check(once, "H5dont_atexit");
  check(H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr), "H5Eset_auto2");
}

}  // namespace stickslip::record
