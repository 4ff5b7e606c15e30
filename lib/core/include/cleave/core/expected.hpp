#pragma once

/// Rust's `?` for std::expected: `CLEAVE_TRY(const Plane plane, Plane::through(a, b, c));` declares `plane` or
/// returns the error to the caller. `CLEAVE_CHECK(expr)` is the same for std::expected<void, E>.

#include <expected>
#include <utility>

#define CLEAVE_CONCAT_IMPL(a, b) a##b
#define CLEAVE_CONCAT(a, b) CLEAVE_CONCAT_IMPL(a, b)

#define CLEAVE_TRY_IMPL(tmp, lhs, ...)                                  \
  auto tmp = (__VA_ARGS__);                                             \
  if (!tmp.has_value()) return std::unexpected(std::move(tmp).error()); \
  lhs = *std::move(tmp)
#define CLEAVE_TRY(lhs, ...) CLEAVE_TRY_IMPL(CLEAVE_CONCAT(cleave_try_, __COUNTER__), lhs, __VA_ARGS__)

#define CLEAVE_CHECK_IMPL(tmp, ...)                 \
  if (auto tmp = (__VA_ARGS__); !tmp.has_value()) { \
    return std::unexpected(std::move(tmp).error()); \
  }                                                 \
  static_assert(true)
#define CLEAVE_CHECK(...) CLEAVE_CHECK_IMPL(CLEAVE_CONCAT(cleave_check_, __COUNTER__), __VA_ARGS__)
