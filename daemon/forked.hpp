/// \file
/// Work in a copy of this process, for what may not survive: HDF5 on files that are damaged or made to
/// deceive.
#pragma once

#include <chrono>
#include <functional>
#include <optional>
#include <string>

#include "core/base/result.hpp"

namespace stickslip::daemon {

struct ForkedAnswer {
  std::string text;           ///< What the work gave; empty if it did not end by itself.
  std::optional<int> signal;  ///< That ended it before.
};

/// All that comes from a descriptor until its other end is closed.
[[nodiscard]] std::string read_to_end(int file);

/// Runs `work` in a child and waits for it. Only while this process has one thread.
/// \param longest  processor time, whole seconds; a child that takes more is ended by SIGXCPU.
/// Errors: kFailure if there can be no child.
[[nodiscard]] base::Result<ForkedAnswer> run_forked(const std::function<std::string()>& work,
                                                    std::chrono::seconds longest);

}  // namespace stickslip::daemon
