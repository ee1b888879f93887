/// \file
/// Options that state the dynamics of the load cell and of the filter before the converter.
#pragma once

#include <string>

#include <CLI/CLI.hpp>

#include "core/base/result.hpp"
#include "core/model/transducer.hpp"

namespace stickslip::cli {

/// As typed; empty: not given.
struct TransducerOptions {
  std::string load_cell_frequency;
  std::string load_cell_damping;
  std::string anti_alias;
  std::string anti_alias_order;
};

/// --load-cell-frequency, --load-cell-damping, --anti-alias, --anti-alias-order. \param options  must live as
/// long as the command.
void add_transducer_options(CLI::App& command, TransducerOptions& options);

/// The transducer; an ideal one if nothing was given. Errors: kUsage with option, value and what is allowed.
[[nodiscard]] base::Result<model::Transducer> stated_transducer(const TransducerOptions& options);

}  // namespace stickslip::cli
