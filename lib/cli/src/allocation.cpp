#include "allocation.hpp"

#include <cstdlib>  // __GLIBC__, where it is there

#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace cleave::cli {

void keep_freed_memory([[maybe_unused]] unsigned threads) {
#ifdef __GLIBC__
  if (threads < 2) return;
  constexpr int never = 1 << 30;
  mallopt(M_MMAP_THRESHOLD, never);  // large arrays come from the heap, where they can be used again
  mallopt(M_TRIM_THRESHOLD, never);  // and the heap does not shrink in between
  mallopt(M_TOP_PAD, 64 << 20);      // it grows by large steps
#endif
}

}  // namespace cleave::cli
