#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace cleave::scene {

/// The stages of a run, in order; names as in summary.json.
enum class Stage : std::uint8_t {
  read,
  draw,
  cut,
  audit,
  stability,
  support,
  monte_carlo,
  elastic,
  contact,
  write,
  report
};

inline constexpr std::array all_stages{Stage::read,      Stage::draw,    Stage::cut,         Stage::audit,
                                       Stage::stability, Stage::support, Stage::monte_carlo, Stage::elastic,
                                       Stage::contact,   Stage::write,   Stage::report};

/// "read", "draw", ... as in summary.json.
[[nodiscard]] std::string_view name_of(Stage stage) noexcept;

struct PlannedStage {
  Stage stage;
  bool run;
  std::string why;                       ///< one sentence part without a full stop: "no excavation and no free face"
  std::vector<std::string> inputs = {};  ///< tables of the scene that it takes
  double seconds = 0;                    ///< of CPU, expected; 0 where it does not count
};

/// Rough figures for people, from the scene alone; never used to decide anything.
struct SizeEstimate {
  double joints = 0;      ///< expected number
  double blocks_low = 1;  ///< blocks: a bracket
  double blocks_high = 1;
  double memory_mb = 0;
  double seconds = 0;  ///< of CPU
};

/// What a run of a scene does and leaves out, one entry a stage in the order of `all_stages`: the run executes those
/// entries and nothing else.
struct Plan {
  std::vector<PlannedStage> stages;
  SizeEstimate estimate;

  [[nodiscard]] bool runs(Stage stage) const noexcept;
};

struct Scene;
[[nodiscard]] Plan make_plan(const Scene& scene);

/// A line for each stage: its name, whether it runs, and why; with `inputs` also what it takes and what it may cost.
[[nodiscard]] std::string describe(const Plan& plan, bool inputs = false);

}  // namespace cleave::scene
