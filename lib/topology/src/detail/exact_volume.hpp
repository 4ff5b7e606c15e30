#pragma once

#include <span>
#include <unordered_map>

#include "cleave/exact/integer.hpp"
#include "detail/fixed_measure.hpp"
#include "detail/phases.hpp"

namespace cleave::topology::detail {

/// Measures what half-faces enclose by integers, where doubles cannot tell; in time linear in their corners.
class ExactMeasures final {
 public:
  ExactMeasures(const Prepared& prepared, const Graph& graph, const Arrangement& arrangement) noexcept
      : prepared_{prepared}, graph_{graph}, arrangement_{arrangement} {}

  /// Of half-faces that close, seen from the side they look to: positive when they enclose it.
  [[nodiscard]] FixedMeasure measure(std::span<const Index> half_faces);
  void add(FixedMeasure& measure, Index half_face);
  /// Sign of the enclosed volume; exact.
  [[nodiscard]] exact::Sign sign(std::span<const Index> half_faces);

 private:
  [[nodiscard]] const exact::FixedPoint& point(Index vertex);
  /// Visits the triangles (a, b, c) of vertices that a half-face falls into, counter-clockwise seen from outside.
  void for_each_triangle(Index half_face, const auto& visit) const;

  const Prepared& prepared_;
  const Graph& graph_;
  const Arrangement& arrangement_;
  std::unordered_map<Index, exact::FixedPoint> points_;
};

}  // namespace cleave::topology::detail
