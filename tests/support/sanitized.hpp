#pragma once

namespace manycontact::test {

/// Whether the sanitizers are on: unoptimised code is much slower and rounds differently.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
inline constexpr bool kSanitized = true;
#else
inline constexpr bool kSanitized = false;
#endif

}  // namespace manycontact::test
