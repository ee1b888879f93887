/// \file
/// Makes the record in this process; the daemon asks a process of its own.
#pragma once

#include "core/record/finaliser.hpp"
#include "daemon/storage/finaliser_process.hpp"

namespace stickslip::test {

inline base::Result<record::Finalised> finalise_plainly(const std::filesystem::path& journal,
                                                        storage::ExpectedScans expected) {
  return record::finalise(journal, {}, record::system_calls(), {}, expected);
}

}  // namespace stickslip::test
