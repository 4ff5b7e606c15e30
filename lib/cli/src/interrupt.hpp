#pragma once

#include <atomic>
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
  /// From now on a first interrupt is only noted (`asked`), with `what` on stderr: the work ends by itself and keeps
  /// what is done. A second one leaves at once.
  void ask_first(std::string what);
  [[nodiscard]] bool asked() const noexcept { return asked_; }
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
  std::string asking_;  // empty: the first interrupt leaves
  std::atomic<bool> asked_{false};
  std::jthread thread_;
};

}  // namespace cleave::cli
