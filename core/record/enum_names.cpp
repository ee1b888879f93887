#include "core/record/enum_names.hpp"

#include <cstdint>
#include <limits>

namespace stickslip::record {

QuantityName name(daq::RawQuantity quantity) noexcept {
  switch (quantity) {
    case daq::RawQuantity::kCounts:
      return {"counts", "1"};
    case daq::RawQuantity::kVolts:
      return {"voltage", "V"};
    case daq::RawQuantity::kForce_N:
      return {"force", "N"};
    case daq::RawQuantity::kCoefficient:
      return {"coefficient", "1"};
  }
  return {"counts", "1"};
}

std::optional<daq::RawQuantity> quantity_from_name(std::string_view text) noexcept {
  using daq::RawQuantity;
  for (const auto quantity :
       {RawQuantity::kCounts, RawQuantity::kVolts, RawQuantity::kForce_N, RawQuantity::kCoefficient}) {
    if (name(quantity).name == text) return quantity;
  }
  return std::nullopt;
}

bool counts_fit_u16(const daq::BoardInfo& board) noexcept {
  return board.maxdata <= std::numeric_limits<std::uint16_t>::max();
}

std::optional<daq::GapCause> gap_cause_from_name(std::string_view text) noexcept {
  using daq::GapCause;
  for (const auto cause :
       {GapCause::kUnknown, GapCause::kOverrun, GapCause::kRingFull, GapCause::kBoardMissing,
        GapCause::kSuspended, GapCause::kMissingScans, GapCause::kStorageFull, GapCause::kDamaged}) {
    if (daq::name(cause) == text) return cause;
  }
  return std::nullopt;
}

std::optional<model::Mode> mode_from_name(std::string_view text) noexcept {
  using model::Mode;
  for (const auto mode : {Mode::kStick, Mode::kSlip, Mode::kSlack}) {
    if (model::name(mode) == text) return mode;
  }
  return std::nullopt;
}

}  // namespace stickslip::record
