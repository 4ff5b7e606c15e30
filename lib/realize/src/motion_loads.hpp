#pragma once

#include <string>
#include <vector>

#include "motion_recorder.hpp"

namespace cleave::scene {

/// Water in joints, surcharges, point and line forces of [stability] on what is let go. `gone`: by block, those that
/// are not there; empty: none.
void add_loads(const Scene& scene, const MotionSettings& settings, const Realization& made,
               const topology::BlockComplex& complex, const std::vector<std::uint8_t>& gone, MotionCast& cast);

/// "water on joints, seismic": what of the loads motion leaves out.
[[nodiscard]] std::string left_out_of(const LoadSet& loads, const MotionSettings& settings);
void add_load_notes(const Scene& scene, MotionResult& result);

}  // namespace cleave::scene
