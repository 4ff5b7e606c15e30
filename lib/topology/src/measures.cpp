#include <cmath>

#include "detail/phases.hpp"
#include "detail/pieces.hpp"

namespace cleave::topology::detail {

std::vector<FaceMeasure> measure_faces(const Prepared& prepared, const Arrangement& arrangement,
                                       const std::vector<Vec>& positions, ThreadLimit threads) {
  using geometry::Vec3;
  std::vector<FaceMeasure> measures;
  // Those of faces that are several plane faces come behind them.
  measures.reserve(arrangement.faces.size() + arrangement.faces.size() / 4);
  measures.resize(arrangement.faces.size());
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
      FaceMeasure measure{0, {}};
      for (Index l = face.first_loop; l < face.first_loop + face.loop_count; ++l) {
        const Index start = arrangement.loops[l];
        Index h = start;
        Vec3 a = point(h) - apex;
        do {
          h = arrangement.next[h];
          const Vec3 b = point(h) - apex;
          const double area = 0.5 * geometry::dot(geometry::cross(a, b), normal);
          measure.area += area;
          measure.centroid += area * (a + b);
          a = b;
        } while (h != start);
      }
      measures[f] = measure;
    }
  });
  return measures;
}

double perimeter_of(const Arrangement& arrangement, const std::vector<Vec>& positions, Index face) {
  const PlaneFace& f = arrangement.faces[face];
  const auto at = [&](Index half_edge) -> const Vec& { return positions[arrangement.start[half_edge]]; };
  const Vec& apex = at(arrangement.loops[f.first_loop]);
  double sum = 0;
  for (Index l = f.first_loop; l < f.first_loop + f.loop_count; ++l) {
    const Index start = arrangement.loops[l];
    Index h = start;
    do {
      const Vec& a = at(h);
      h = arrangement.next[h];
      const Vec& b = at(h);
      const auto along = [&](std::size_t k) { return std::abs((b[k] - apex[k]) - (a[k] - apex[k])); };
      sum += along(0) + along(1) + along(2);
    } while (h != start);
  }
  return sum;
}

double Cones::of(Index face) {
  const PlaneFace& f = arrangement_.faces[face];
  if (f.plane != plane_) {
    plane_ = f.plane;
    const auto n = prepared_.planes[plane_].unit_normal();
    normal_ = {n[0], n[1], n[2]};
  }
  const Vec& apex = positions_[arrangement_.start[arrangement_.loops[f.first_loop]]];
  return measures_[face].area * geometry::dot(normal_, geometry::Vec3{apex[0], apex[1], apex[2]});
}

}  // namespace cleave::topology::detail
