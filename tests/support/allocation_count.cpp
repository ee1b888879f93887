#include "tests/support/allocation_count.hpp"

#include <cstddef>
#include <cstdlib>
#include <new>

#include "tests/support/sanitized.hpp"

namespace {

thread_local std::uint64_t allocations = 0;

}  // namespace

namespace stickslip::test {

std::uint64_t allocation_count() noexcept { return allocations; }

}  // namespace stickslip::test

#ifdef STICKSLIP_SANITIZED

// A sanitizer keeps its own operators, and tells of each piece that they or malloc() give.
// NOLINTNEXTLINE(bugprone-reserved-identifier): its name [compiler-rt, sanitizer/allocator_interface.h].
extern "C" void __sanitizer_malloc_hook(const volatile void* /*memory*/, std::size_t /*size*/) {
  ++allocations;
}

#else

// The array and nothrow forms of the library call these; over-aligned types are not counted.
void* operator new(std::size_t size) {
  ++allocations;
  if (void* memory = std::malloc(size == 0 ? 1 : size)) return memory;
  throw std::bad_alloc();
}

void operator delete(void* memory) noexcept { std::free(memory); }

void operator delete(void* memory, std::size_t /*size*/) noexcept { std::free(memory); }

#endif
