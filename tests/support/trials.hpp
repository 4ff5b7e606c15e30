#pragma once

/// How many random trials a test runs: all in optimised builds, a share where each costs many times more.

namespace cleave::testing {

[[nodiscard]] constexpr int trials(int optimised, int checked) {
#if !defined(NDEBUG) || defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  static_cast<void>(optimised);
  return checked;
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer) || __has_feature(memory_sanitizer)
  static_cast<void>(optimised);
  return checked;
#else
  static_cast<void>(checked);
  return optimised;
#endif
#else
  static_cast<void>(checked);
  return optimised;
#endif
}

}  // namespace cleave::testing
