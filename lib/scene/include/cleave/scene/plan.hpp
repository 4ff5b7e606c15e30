#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "cleave/scene/scene.hpp"

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
  std::string why;  ///< one sentence part without a full stop: "no excavation and no free face"
};

/// Rough figures for people, from the scene alone; never used to decide anything.
struct SizeEstimate {
  double joints = 0;      ///< expected number
  double blocks_low = 1;  ///< blocks: a bracket
  double blocks_high = 1;
  double memory_mb = 0;
  double seconds = 0;  ///< of CPU
};

/// What a run of a scene does and leaves out, one entry a stage in the order of `all_stages`.
struct Plan {
  std::vector<PlannedStage> stages;
  SizeEstimate estimate;

  [[nodiscard]] bool runs(Stage stage) const noexcept;
};

[[nodiscard]] Plan make_plan(const Scene& scene);

}  // namespace cleave::scene
