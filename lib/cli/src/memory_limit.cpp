#include "memory_limit.hpp"

#include <sys/resource.h>

#include <algorithm>

namespace cleave::cli {

bool limit_memory(std::uint64_t bytes) noexcept {
  // Of private memory that may be written to: addresses alone, which allocators take in advance, are not counted.
  rlimit limit{};
  if (::getrlimit(RLIMIT_DATA, &limit) != 0) return false;
  limit.rlim_cur = std::min<std::uint64_t>(limit.rlim_cur, bytes);  // RLIM_INFINITY is the largest number
  return ::setrlimit(RLIMIT_DATA, &limit) == 0;
}

}  // namespace cleave::cli
