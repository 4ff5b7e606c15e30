#pragma once

/// What work cost: wall time, processor time and memory, by named stage.

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace cleave {

/// Seconds and megabytes (10^6 bytes).
struct StageCost {
  std::string stage;
  double wall_s = 0.0;
  double cpu_s = 0.0;  ///< of all threads of the process
  /// Most memory the process ever held up to the end of the stage (resident set). It never falls from stage to stage:
  /// the operating system's own high-water mark is not reset, so that other programs that watch us see the truth.
  double peak_rss_mb = 0.0;
  friend bool operator==(const StageCost&, const StageCost&) = default;
};

[[nodiscard]] double peak_memory_mb() noexcept;
/// Of all threads of this process since its start.
[[nodiscard]] double cpu_seconds() noexcept;

/// Measures stages that follow each other (not nested).
class StageTimer final {
 public:
  StageTimer();

  /// Runs `work`, books its cost under `stage` and returns what it returns. A stage run twice has two entries.
  template <class Work>
  decltype(auto) run(std::string_view stage, Work&& work) {
    const Running running{*this, stage};
    return std::forward<Work>(work)();
  }

  [[nodiscard]] const std::vector<StageCost>& stages() const noexcept { return stages_; }
  /// Everything since the timer was made, also what lies between stages.
  [[nodiscard]] StageCost total() const;

 private:
  struct Clock {
    double wall_s = 0.0;
    double cpu_s = 0.0;
  };
  [[nodiscard]] static Clock now() noexcept;
  [[nodiscard]] static StageCost since(Clock start, std::string_view stage);

  class Running final {
   public:
    Running(StageTimer& timer, std::string_view stage) : timer_{timer}, stage_{stage}, start_{now()} {}
    ~Running() { timer_.stages_.push_back(since(start_, stage_)); }
    Running(const Running&) = delete;
    Running& operator=(const Running&) = delete;

   private:
    StageTimer& timer_;
    std::string_view stage_;
    Clock start_;
  };

  std::vector<StageCost> stages_;
  Clock start_;
};

}  // namespace cleave
