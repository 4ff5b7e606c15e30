#pragma once

#include <string>
#include <vector>

#include "cleave/realize/run.hpp"

namespace cleave::scene {

/// Where joints lie on one another the one counts that bears less shear under this normal stress.
inline constexpr Stress normal_stress_on_overlaps = pascals(100e3);

/// Joints that part less than was perhaps meant.
void add_cut_notes(const Scene& scene, const Realization& made, std::vector<std::string>& notes);

/// Blocks below the limits of `[micro_blocks]`.
void add_micro_note(const topology::BlockComplex& complex, const MicroBlocks& limits, std::vector<std::string>& notes);

/// That only a part of the rock was cut.
[[nodiscard]] std::string note_on(const WindowInfo& window);

/// Openings that lie partly outside the rock, or take nothing that an earlier one has not.
void add_excavation_notes(const std::vector<ExcavationInfo>& excavations, std::vector<std::string>& notes);

}  // namespace cleave::scene
