/// \file
/// What can be imported from a file, for those who have not chosen yet.
#pragma once

#include "io/traces/import.hpp"

namespace stickslip::traces {

/// kUsage: the columns, and the command that imports the likely one.
[[nodiscard]] base::Error no_column_chosen(const ImportRequest& request, const Source& source,
                                           const Dialect& dialect);

}  // namespace stickslip::traces
