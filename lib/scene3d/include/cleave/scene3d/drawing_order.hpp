#pragma once

#include <cstddef>
#include <vector>

#include "cleave/dfn/sample.hpp"
#include "cleave/scene/table_reader.hpp"
#include "cleave/scene3d/scene.hpp"

namespace cleave::scene {

/// Numbers of the sets, each behind those it ends at, otherwise as in the scene; sets that end at one another in a
/// circle, and what ends at them, are left out.
[[nodiscard]] std::vector<std::size_t> drawing_order(const std::vector<RandomSet>& sets);

/// Given joints of a set, as joints drawn later see them.
[[nodiscard]] std::vector<dfn::SampledJoint> given_joints(const std::vector<MeasuredJoint>& given, SetId set);

/// Joints that end at others lose area: sets with an intensity by area or along a line are drawn in so many more that
/// what is left has it. The share that is left comes from trial draws with seeds of their own: the same for every seed
/// and realization. Where a set keeps less than all, a note says how much.
void keep_intensities(Scene& scene, Problems& problems);

}  // namespace cleave::scene
