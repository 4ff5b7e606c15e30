#pragma once

#include <span>
#include <vector>

#include "cleave/geometry/vec3.hpp"
#include "cleave/stability/result.hpp"
#include "cleave/stochastic/record.hpp"
#include "cleave/topology/block_complex.hpp"

namespace cleave::stochastic {

/// What is asked of every realization besides the counts.
struct Questions {
  std::vector<double> volumes_m3;    ///< count key blocks above each
  std::vector<geometry::Vec3> axis;  ///< polyline of the tunnel that chainage runs along; empty: none
  std::uint32_t chainage_parts = 0;  ///< equal parts of the axis
  bool groups = false;               ///< blocks judged together decide
  bool clamped = false;              ///< stress across joints is looked at
};

/// Length of a polyline, m.
[[nodiscard]] double length_of(std::span<const geometry::Vec3> axis) noexcept;
/// Where the foot of `point` on the polyline lies, m from its start: the nearest one, the first of equally near ones.
[[nodiscard]] double chainage_of(std::span<const geometry::Vec3> axis, geometry::Vec3 point) noexcept;

/// Counts one realization. `analysis` may be null: no stability stage. A face to a block that left before counts as
/// free, as it was when the block was judged.
[[nodiscard]] Record measure(const topology::BlockComplex& complex, const stability::Analysis* analysis,
                             const Questions& questions);

}  // namespace cleave::stochastic
