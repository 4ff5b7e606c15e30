#pragma once

/// How far a run is: said on stderr, or asked for by whoever started it, who may also stop it.

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

namespace cleave {

enum class ProgressStyle : std::uint8_t {
  quiet,     ///< nothing at all
  lines,     ///< one line every 10 s, for logs
  terminal,  ///< one line that is written again and again
};

/// `terminal` when stderr is one, else `lines`; `quiet` when asked.
[[nodiscard]] ProgressStyle progress_style_of_stderr(bool quiet) noexcept;

/// Thrown by `begin` and `advance` after `stop`, through all that is between: only who called `stop` sees it.
struct Stopped {};

/// Stage, share done, time left. `advance` may be called from any thread and costs one atomic addition.
class Progress final {
 public:
  /// A line reaches the sink whole, with its line end or carriage return.
  using Sink = std::function<void(std::string_view)>;
  /// Seconds from any start, never going back.
  using Clock = std::function<double()>;

  /// Writes to stderr and looks at the clock from a thread of its own, so that a stage that never calls `advance`
  /// still shows that it lives.
  explicit Progress(ProgressStyle style);
  /// For tests: writes to `sink`, and only when `tick` is called.
  Progress(ProgressStyle style, Sink sink, Clock clock);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// Starts a stage of `total` equal pieces (0: unknown). The stage before it ends.
  void begin(std::string_view stage, std::uint64_t total = 0);
  /// `count` more pieces are done.
  void advance(std::uint64_t count = 1);
  /// `count` more pieces were done by an earlier run: they count in the share, and say nothing of the time left.
  void found(std::uint64_t count);
  /// Text behind the share, say a running mean with its interval; an empty one takes it away.
  void note(std::string_view text);
  /// The stage is over; a terminal's line is wiped, so that what follows starts on a clean line.
  void end();
  /// Writes if it is time to.
  void tick();

  /// A stage and how much of it is done.
  struct Seen {
    std::string stage;
    std::uint64_t done = 0, total = 0;  ///< total 0: unknown
  };
  /// The stage that runs now, from any thread; none between stages.
  [[nodiscard]] std::optional<Seen> seen() const;
  /// Ends the run at its next stage or step, by Stopped. From any thread.
  void stop() noexcept;

 private:
  class State;
  std::unique_ptr<State> state_;
};

}  // namespace cleave
