#include "daemon/types/storage_state.hpp"

#include <fmt/format.h>

namespace stickslip::daemon {

std::optional<std::string> why_no_test(const StorageState& storage) {
  if (storage.kind == StorageState::Kind::kOk) return std::nullopt;
  return fmt::format("storage {}: {}; {}", name(storage.kind), storage.why, storage.to_do);
}

}  // namespace stickslip::daemon
