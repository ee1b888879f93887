/// \file
/// What a report opens with: what was tested, how, by whom and with what, as far as the records state it; and
/// the verdict.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "core/record/record.hpp"

namespace stickslip::report {

struct Material;

/// The facts of the form that one record states, in the order of form_of(); empty: not stated.
inline constexpr std::size_t kFactCount = 15;
using RecordFacts = std::array<std::string, kFactCount>;

/// Facts without a field of their own (lot, conditioning, climate, contact time) are metadata.
/// \param speed  as text; empty: unknown.
[[nodiscard]] RecordFacts facts_of(const record::RecordHeader& header, const std::string& speed);

/// One line of the form block.
struct FormLine {
  std::string_view name;            ///< In JSON.
  std::string_view label;           ///< For people.
  std::vector<std::string> values;  ///< As stated, each once; empty: not stated.
  std::size_t not_stated = 0;       ///< Records without it.
  std::string text;  ///< "Ann"; "3 operators: Ann, Bo, Cy"; "Ann; not stated in 1 of 5"; "–": not stated.
};

[[nodiscard]] std::vector<FormLine> form_of(const Material& material);

/// "PASS", "FAIL" or why there is none; then departures from the method and findings: one line.
[[nodiscard]] std::string verdict_of(const Material& material);

}  // namespace stickslip::report
