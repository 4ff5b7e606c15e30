#pragma once

#include <cstdint>

namespace cleave::cli {

/// Below the least the program itself does not start.
inline constexpr std::uint64_t least_memory = 64'000'000, most_memory = 1'000'000'000'000'000;

/// Memory of this process beyond which allocations fail, so that the run ends with the machine's fault instead of
/// taking the machine down. A limit that already stands and is lower stays. False where the system knows no such limit.
[[nodiscard]] bool limit_memory(std::uint64_t bytes) noexcept;

/// Megabytes (10^6 bytes) of this machine, or of the control group that the process lives in where that is less.
[[nodiscard]] double machine_memory_mb();

}  // namespace cleave::cli
