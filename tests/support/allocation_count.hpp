/// \file
/// Counts what operator new hands out, to prove that a real-time path does not allocate. Linking
/// the support library's allocation_count.cpp replaces operator new for the whole program; under a sanitizer
/// it listens to the sanitizer's allocator, and counts malloc() as well.
#pragma once

#include <cstdint>

namespace stickslip::test {

/// Allocations of the calling thread so far.
[[nodiscard]] std::uint64_t allocation_count() noexcept;

}  // namespace stickslip::test
