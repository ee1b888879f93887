/// \file
/// Names of enumerators in files.
#pragma once

#include <optional>
#include <string_view>

#include "core/daq/board.hpp"
#include "core/daq/gap.hpp"
#include "core/model/truth.hpp"

namespace stickslip::record {

/// Name and unit of the raw values.
struct QuantityName {
  std::string_view name;  ///< Of the data set and in JSON.
  std::string_view unit;  ///< SI; "1" for counts and coefficients.
};

[[nodiscard]] QuantityName name(daq::RawQuantity quantity) noexcept;
[[nodiscard]] std::optional<daq::RawQuantity> quantity_from_name(std::string_view text) noexcept;
/// Whether the board's counts are stored as u16 (maxdata ≤ 65 535), not u32. No meaning without counts.
[[nodiscard]] bool counts_fit_u16(const daq::BoardInfo& board) noexcept;
[[nodiscard]] std::optional<daq::GapCause> gap_cause_from_name(std::string_view text) noexcept;
[[nodiscard]] std::optional<model::Mode> mode_from_name(std::string_view text) noexcept;

}  // namespace stickslip::record
