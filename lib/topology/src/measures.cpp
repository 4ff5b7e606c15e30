#include <cmath>

#include "detail/phases.hpp"
#include "detail/pieces.hpp"

namespace cleave::topology::detail {

std::vector<FaceMeasure> measure_faces(const Prepared& prepared, const Arrangement& arrangement,
                                       const std::vector<Vec>& positions, ThreadLimit threads) {
  using geometry::Vec3;
  std::vector<FaceMeasure> measures(arrangement.faces.size());
  const auto point = [&](Index half_edge) {
    const Vec& p = positions[arrangement.start[half_edge]];
    return Vec3{p[0], p[1], p[2]};
  };
  in_pieces(measures.size(), 4096, threads, [&](std::size_t first, std::size_t last) {
    Index plane = none;
    Vec3 normal{};
    for (std::size_t f = first; f < last; ++f) {
      const PlaneFace& face = arrangement.faces[f];
      if (face.cover_count == 0) continue;
      if (face.plane != plane) {
        plane = face.plane;
        const auto n = prepared.planes[plane].unit_normal();
        normal = {n[0], n[1], n[2]};
      }
      const Vec3 apex = point(arrangement.loops[face.first_loop]);
      FaceMeasure measure{0, 0, {}, 0};
      for (Index l = face.first_loop; l < face.first_loop + face.loop_count; ++l) {
        const Index start = arrangement.loops[l];
        Index h = start;
        Vec3 a = point(h) - apex;
        do {
          h = arrangement.next[h];
          const Vec3 b = point(h) - apex;
          const double area = 0.5 * geometry::dot(geometry::cross(a, b), normal);
          measure.area += area;
          measure.moment3 += area * (a + b);
          measure.perimeter += std::abs(b.x - a.x) + std::abs(b.y - a.y) + std::abs(b.z - a.z);
          a = b;
        } while (h != start);
      }
      measure.cone = measure.area * geometry::dot(normal, apex);
      measures[f] = measure;
    }
  });
  return measures;
}

}  // namespace cleave::topology::detail
