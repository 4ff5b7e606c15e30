#include "memory_limit.hpp"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <limits>

namespace cleave::cli {

bool limit_memory(std::uint64_t bytes) noexcept {
  // Of private memory that may be written to: addresses alone, which allocators take in advance, are not counted.
  rlimit limit{};
  if (::getrlimit(RLIMIT_DATA, &limit) != 0) return false;
  limit.rlim_cur = std::min<std::uint64_t>(limit.rlim_cur, bytes);  // RLIM_INFINITY is the largest number
  return ::setrlimit(RLIMIT_DATA, &limit) == 0;
}

double machine_memory_mb() {
  const long pages = ::sysconf(_SC_PHYS_PAGES), bytes = ::sysconf(_SC_PAGESIZE);
  double memory = pages > 0 && bytes > 0 ? static_cast<double>(pages) * static_cast<double>(bytes)
                                         : std::numeric_limits<double>::infinity();
  for (const char* const file : {"/sys/fs/cgroup/memory.max", "/sys/fs/cgroup/memory/memory.limit_in_bytes"}) {
    double limit = 0;
    if (std::ifstream{file} >> limit) memory = std::min(memory, limit);  // "max" is no number: no limit
  }
  return memory / 1e6;
}

}  // namespace cleave::cli
