#pragma once

#include <functional>
#include <mutex>
#include <string>
#include <thread>

namespace cleave::cli {

/// Turns SIGINT, SIGTERM, SIGHUP and SIGQUIT into a clean end: from its construction on a thread of its own waits for
/// them, calls `clean_up` and leaves the program with 130 at once, whatever the other threads do. Must be made before
/// other threads, so that they inherit the mask.
class InterruptWatch final {
 public:
  InterruptWatch();
  ~InterruptWatch() = default;
  InterruptWatch(const InterruptWatch&) = delete;
  InterruptWatch& operator=(const InterruptWatch&) = delete;

  /// What to do before leaving; called while `guarded` work waits. Replaces what was set before.
  /// `what` is said on stderr afterwards.
  void on_interrupt(std::function<void()> clean_up, std::string what = "interrupted; nothing was written");
  /// Runs `work` so that an interrupt comes wholly before or wholly after it.
  template <class Work>
  decltype(auto) guarded(Work&& work) {
    const std::scoped_lock lock{mutex_};
    return std::forward<Work>(work)();
  }

 private:
  void watch(const std::stop_token& stop);
  std::mutex mutex_;
  std::function<void()> clean_up_;
  std::string what_ = "interrupted; nothing was written";
  std::jthread thread_;
};

}  // namespace cleave::cli
