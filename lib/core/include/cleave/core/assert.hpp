#pragma once

/// Assertions for bugs of ours (never for bad input, which gets a typed error).
///
/// `CLEAVE_ASSERT` is on in every build and aborts with the place. `CLEAVE_DEBUG_ASSERT` is for checks that cost
/// more than O(1); it is on unless NDEBUG is defined.

namespace cleave::detail {
[[noreturn]] void assertion_failed(const char* expression, const char* file, int line) noexcept;
}  // namespace cleave::detail

#define CLEAVE_ASSERT(expression) \
  ((expression) ? static_cast<void>(0) : ::cleave::detail::assertion_failed(#expression, __FILE__, __LINE__))

#ifdef NDEBUG
#define CLEAVE_DEBUG_ASSERT(expression) static_cast<void>(0)
#else
#define CLEAVE_DEBUG_ASSERT(expression) CLEAVE_ASSERT(expression)
#endif
