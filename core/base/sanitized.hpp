/// \file
/// kSanitized: whether this build runs under AddressSanitizer or ThreadSanitizer. Such a build is ten times
/// slower and maps terabytes of address space.
#pragma once

// GCC has macros for it, clang has features.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define STICKSLIP_SANITIZED
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define STICKSLIP_SANITIZED
#endif
#endif

namespace stickslip::base {

#ifdef STICKSLIP_SANITIZED
inline constexpr bool kSanitized = true;
#else
inline constexpr bool kSanitized = false;
#endif

}  // namespace stickslip::base
