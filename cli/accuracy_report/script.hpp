/// \file
/// The text of cli/accuracy_report/scipy_chain.py; cmake/embed.cmake builds it into the program.
#pragma once

#include <string_view>

namespace stickslip::accuracy_report {

[[nodiscard]] std::string_view scipy_chain_py() noexcept;

}  // namespace stickslip::accuracy_report
