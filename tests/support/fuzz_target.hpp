#pragma once

/// Entry point of a fuzz target:
///
///     CLEAVE_FUZZ_TARGET(bytes) {  // std::span<const std::uint8_t>
///       ByteSource source{bytes};
///       CLEAVE_ASSERT(what must hold);
///     }
///
/// libFuzzer calls it when built for fuzzing, replay_main.cpp on stored inputs otherwise.

#include <cstddef>
#include <cstdint>
#include <span>

// NOLINTBEGIN(readability-identifier-naming): the name is libFuzzer's
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);
// NOLINTEND(readability-identifier-naming)

#ifdef __clang__
#define CLEAVE_UNCHECKED_BEGIN _Pragma("clang unsafe_buffer_usage begin")
#define CLEAVE_UNCHECKED_END _Pragma("clang unsafe_buffer_usage end")
#else
#define CLEAVE_UNCHECKED_BEGIN
#define CLEAVE_UNCHECKED_END
#endif

// NOLINTBEGIN(bugprone-macro-parentheses): the macro's argument is a name
// The one place where libFuzzer's pointer and length become a span.
#define CLEAVE_FUZZ_TARGET(bytes)                                                     \
  static void cleave_fuzz_one(std::span<const std::uint8_t> bytes);                   \
  CLEAVE_UNCHECKED_BEGIN                                                              \
  extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) { \
    cleave_fuzz_one(std::span<const std::uint8_t>(data, size));                       \
    return 0;                                                                         \
  }                                                                                   \
  CLEAVE_UNCHECKED_END                                                                \
  static void cleave_fuzz_one(std::span<const std::uint8_t> bytes)
// NOLINTEND(bugprone-macro-parentheses)
