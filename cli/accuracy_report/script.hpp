/// \file
/// cli/accuracy_report/scipy_chain.py, built in by cmake/embed.cmake.
#pragma once

#include <string_view>

namespace stickslip::accuracy_report {

[[nodiscard]] std::string_view scipy_chain_py() noexcept;

}  // namespace stickslip::accuracy_report
