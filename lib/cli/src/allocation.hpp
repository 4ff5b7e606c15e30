#pragma once

namespace cleave::cli {

/// Keeps memory that was freed, so that the next stage need not ask the system for it again page by page. Only when
/// more than one thread is used: pages are made under a lock of the whole process, so threads wait for each other
/// there. One thread gains little and would hold more memory at its peak, so nothing is changed for it. Has an effect
/// with glibc only.
void keep_freed_memory(unsigned threads);

}  // namespace cleave::cli
