#include "interrupt.hpp"

#include <signal.h>
#include <time.h>

#include <cstdio>
#include <cstdlib>
#include <utility>

#include "exit_code.hpp"

namespace cleave::cli {
namespace {

sigset_t ending_signals() {
  sigset_t set;
  sigemptyset(&set);
  for (const int number : {SIGINT, SIGTERM, SIGHUP, SIGQUIT}) sigaddset(&set, number);
  return set;
}

}  // namespace

InterruptWatch::InterruptWatch() {
  const sigset_t set = ending_signals();
  pthread_sigmask(SIG_BLOCK, &set, nullptr);
  thread_ = std::jthread{[this](const std::stop_token& stop) { watch(stop); }};
}

void InterruptWatch::on_interrupt(std::function<void()> clean_up, std::string what) {
  const std::scoped_lock lock{mutex_};
  what_ = std::move(what);
  clean_up_ = std::move(clean_up);
}

void InterruptWatch::ask_first(std::string what) {
  const std::scoped_lock lock{mutex_};
  asking_ = std::move(what);
}

void InterruptWatch::watch(const std::stop_token& stop) {
  const sigset_t set = ending_signals();
  const timespec pause{.tv_sec = 0, .tv_nsec = 50'000'000};
  while (!stop.stop_requested()) {
    if (sigtimedwait(&set, nullptr, &pause) < 0) continue;
    const std::scoped_lock lock{mutex_};
    if (!asking_.empty() && !asked_) {
      asked_ = true;
      std::fputs(("\ncleave: " + asking_ + "\n").c_str(), stderr);
      continue;
    }
    if (clean_up_) clean_up_();
    std::fputs(("\ncleave: " + what_ + "\n").c_str(), stderr);
    std::_Exit(static_cast<int>(ExitCode::interrupted));
  }
}

}  // namespace cleave::cli
