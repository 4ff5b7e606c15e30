#include "cleave/core/progress.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <optional>
#include <string>
#include <utility>

#include "cleave/core/mutex.hpp"

#if CLEAVE_THREADS
#include <condition_variable>
#include <thread>
#endif

namespace cleave {
namespace {

constexpr double terminal_period_s = 0.2;
constexpr double lines_period_s = 10.0;
constexpr std::string_view wipe_line = "\r\x1b[K";

std::string duration(double seconds) {
  const std::int64_t s = std::llround(std::clamp(seconds, 0.0, 1e9));
  if (s < 60) return fmt::format("{} s", s);
  if (s < 3600) return fmt::format("{} min {:02} s", s / 60, s % 60);
  return fmt::format("{} h {:02} min", s / 3600, s / 60 % 60);
}

/// Ends the run at once where a program is built without exceptions.
[[noreturn]] void stopped() {
#ifdef __cpp_exceptions
  throw Stopped{};
#else
  std::abort();
#endif
}

struct Stage {
  std::string name;
  std::uint64_t total = 0;
  double start_s = 0.0;
  std::string note;
};

}  // namespace

class Progress::State final {
 public:
  State(ProgressStyle style, Sink sink, Clock clock)
      : style_{style}, sink_{std::move(sink)}, clock_{std::move(clock)}, last_s_{clock_()} {}

  void begin(std::string_view name, std::uint64_t total) {
    if (stop_.load(std::memory_order_relaxed)) stopped();
    const Lock lock{mutex_};
    stage_ = Stage{.name = std::string{name}, .total = total, .start_s = clock_(), .note = {}};
    done_.store(0, std::memory_order_relaxed);
    found_.store(0, std::memory_order_relaxed);
  }

  void advance(std::uint64_t count) {
    done_.fetch_add(count, std::memory_order_relaxed);
    if (stop_.load(std::memory_order_relaxed)) stopped();
  }

  void found(std::uint64_t count) {
    found_.fetch_add(count, std::memory_order_relaxed);
    advance(count);
  }

  [[nodiscard]] std::optional<Seen> seen() {
    const Lock lock{mutex_};
    if (!stage_) return std::nullopt;
    return Seen{stage_->name, done_.load(std::memory_order_relaxed), stage_->total};
  }

  void stop() noexcept { stop_.store(true, std::memory_order_relaxed); }

  void note(std::string_view text) {
    const Lock lock{mutex_};
    if (stage_) stage_->note = text;
  }

  void end() {
    const Lock lock{mutex_};
    stage_.reset();
    if (std::exchange(line_shown_, false)) sink_(wipe_line);
  }

  void tick() {
    const Lock lock{mutex_};
    if (!stage_) return;
    const double now = clock_();
    switch (style_) {
      case ProgressStyle::quiet: return;
      case ProgressStyle::lines:
        if (now - last_s_ < lines_period_s) return;
        sink_(line(*stage_, now) + '\n');
        break;
      case ProgressStyle::terminal:
        if (now - last_s_ < terminal_period_s) return;
        sink_(std::string{wipe_line} + line(*stage_, now));
        line_shown_ = true;
        break;
    }
    last_s_ = now;
  }

  /// Calls tick() until the state goes away.
  void start_ticking() {
#if CLEAVE_THREADS
    ticker_ = std::jthread{[this](const std::stop_token& stop) {
      std::mutex sleep;
      std::condition_variable_any wake;
      std::unique_lock lock{sleep};
      const auto period = std::chrono::duration<double>{terminal_period_s};
      while (!wake.wait_for(lock, stop, period, [&stop] { return stop.stop_requested(); })) tick();
    }};
#endif
  }

 private:
  [[nodiscard]] std::string line(const Stage& stage, double now) const {
    const double elapsed = now - stage.start_s;
    const auto done = std::min(done_.load(std::memory_order_relaxed), stage.total);
    std::string text;
    const auto found = std::min(found_.load(std::memory_order_relaxed), done);
    if (stage.total > 0 && done > found) {
      const double share = static_cast<double>(done) / static_cast<double>(stage.total);
      const double left = elapsed * static_cast<double>(stage.total - done) / static_cast<double>(done - found);
      text = fmt::format("{}: {:.0f} %, {} left", stage.name, 100.0 * share, duration(left));
    } else {
      text = fmt::format("{}: {}", stage.name, duration(elapsed));
    }
    if (!stage.note.empty()) text += fmt::format(" ({})", stage.note);
    return text;
  }

  ProgressStyle style_;
  Sink sink_;
  Clock clock_;
  Mutex mutex_;
  std::optional<Stage> stage_;
  double last_s_;
  bool line_shown_ = false;
  std::atomic<std::uint64_t> done_{0};
  std::atomic<std::uint64_t> found_{0};
  std::atomic<bool> stop_{false};
#if CLEAVE_THREADS
  std::jthread ticker_;  // last: it stops before anything it looks at goes away
#endif
};

ProgressStyle progress_style_of_stderr(bool quiet) noexcept {
  if (quiet) return ProgressStyle::quiet;
  return isatty(STDERR_FILENO) == 1 ? ProgressStyle::terminal : ProgressStyle::lines;
}

Progress::Progress(ProgressStyle style)
    : Progress{
          style, [](std::string_view text) { std::fwrite(text.data(), 1, text.size(), stderr); },
          [] { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }} {
  if (style != ProgressStyle::quiet) state_->start_ticking();
}

Progress::Progress(ProgressStyle style, Sink sink, Clock clock)
    : state_{std::make_unique<State>(style, std::move(sink), std::move(clock))} {}

Progress::~Progress() { state_->end(); }

void Progress::begin(std::string_view stage, std::uint64_t total) { state_->begin(stage, total); }
void Progress::advance(std::uint64_t count) { state_->advance(count); }
void Progress::found(std::uint64_t count) { state_->found(count); }
void Progress::note(std::string_view text) { state_->note(text); }
void Progress::end() { state_->end(); }
void Progress::tick() { state_->tick(); }
std::optional<Progress::Seen> Progress::seen() const { return state_->seen(); }
void Progress::stop() noexcept { state_->stop(); }

}  // namespace cleave
