/// \file
/// Version and commit of this program.
#pragma once

namespace stickslip::base {

/// Version, such as "0.1.0".
extern const char* const kVersion;
/// Commit it was built from, with "-dirty" if the tree had changes; "unknown" outside git.
extern const char* const kCommit;

}  // namespace stickslip::base
