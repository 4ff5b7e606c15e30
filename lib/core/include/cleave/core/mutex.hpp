#pragma once

/// A lock that costs nothing where a program has one thread only (WebAssembly): there the standard library has none.

#ifdef __STDCPP_THREADS__
#include <mutex>
#endif

namespace cleave {

#ifdef __STDCPP_THREADS__
using Mutex = std::mutex;
using Lock = std::unique_lock<std::mutex>;
#else
struct Mutex {};
class [[nodiscard]] Lock final {
 public:
  explicit Lock(Mutex&) noexcept {}
  void lock() noexcept {}
  void unlock() noexcept {}
};
#endif

}  // namespace cleave
