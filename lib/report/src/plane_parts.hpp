#pragma once

#include <string>
#include <string_view>

#include "cleave/bem/vec2.hpp"
#include "cleave/report/json.hpp"
#include "cleave/report/summary.hpp"
#include "cleave/scene/plan.hpp"
#include "cleave/scene/run_result.hpp"

// What summaries and pages of different kinds of scenes have in common.
namespace cleave::report {

/// Plan and cost of a run as rows of summary.json.
[[nodiscard]] Summary head_of(std::string title, std::uint64_t seed, std::string scene_sha256, const scene::Plan& plan,
                              const scene::RunCost& cost);

/// `key`: [x, y].
void write_pair(JsonWriter& json, std::string_view key, bem::Vec2 v);

/// The head of a scene of plane bodies, which has no joints: title to input. `Result`: BodiesResult or ContactResult.
template <class Result>
void write_plane_head(JsonWriter& json, const Result& result) {
  const Summary head = head_of(result.title, result.seed, result.scene_sha256, result.plan, result.cost);
  write_summary_head(json, head);
  write_summary_input(json, head.input);
}

/// A page up to its first section: `style` follows the style of all reports; `sub` is a line below the title, as HTML.
[[nodiscard]] std::string plane_page_head(std::string_view title, std::string_view sub, std::string_view style);

}  // namespace cleave::report
