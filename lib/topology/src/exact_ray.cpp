#include "detail/exact_ray.hpp"

#include <cmath>

namespace cleave::topology::detail {

ExactRay::ExactRay(const Prepared& prepared, const Graph& graph, const Arrangement& arrangement, const Meet& a,
                   const Meet& b, double share, std::array<std::int64_t, 3> direction)
    : prepared_{prepared}, graph_{graph}, arrangement_{arrangement}, direction_{direction} {
  const RationalPoint p = rational_position(prepared, a), q = rational_position(prepared, b);
  const Rational part{share};
  for (std::size_t k = 0; k < 3; ++k) from_[k] = p[k] + part * (q[k] - p[k]);
}

ExactRay::Hit ExactRay::shoot(Index f) const {
  const PlaneFace& face = arrangement_.faces[f];
  const auto& n = prepared_.planes[face.plane].normal();
  const RationalPoint corner =
      rational_position(prepared_, graph_.meet(arrangement_.start[arrangement_.loops[face.first_loop]]));
  Rational height = 0, rate = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const boost::multiprecision::cpp_int c{n[k]};
    height += c * (from_[k] - corner[k]);
    rate += c * direction_[k];
  }
  if (rate == 0) return {.kind = height == 0 ? Hit::Kind::unclear : Hit::Kind::missed, .at = -1};  // along it
  Hit hit{.kind = Hit::Kind::missed, .at = -height / rate, .from_positive = rate < 0};
  if (hit.at < 0) return hit;
  RationalPoint p;
  for (std::size_t k = 0; k < 3; ++k) p[k] = from_[k] + hit.at * direction_[k];
  hit.kind = inside(face, p);
  return hit;
}

/// Of a point of the face's plane: how often its loops pass on one side of it, seen along the axis nearest the normal.
ExactRay::Hit::Kind ExactRay::inside(const PlaneFace& face, const RationalPoint& p) const {
  const auto [u, v] = View{prepared_.planes[face.plane].unit_normal()};
  bool inside = false;
  for (Index l = face.first_loop; l < face.first_loop + face.loop_count; ++l) {
    const Index start = arrangement_.loops[l];
    Index h = start;
    RationalPoint a = rational_position(prepared_, graph_.meet(arrangement_.start[h]));
    do {
      h = arrangement_.next[h];
      const RationalPoint b = rational_position(prepared_, graph_.meet(arrangement_.start[h]));
      if (b[v] == p[v]) return Hit::Kind::unclear;  // past a corner: another ray will do
      if ((a[v] > p[v]) != (b[v] > p[v])) {
        const Rational off = (b[u] - a[u]) * (p[v] - a[v]) - (b[v] - a[v]) * (p[u] - a[u]);
        if (off == 0) return Hit::Kind::unclear;
        if ((off > 0) == (b[v] > a[v])) inside = !inside;
      }
      a = b;
    } while (h != start);
  }
  return inside ? Hit::Kind::met : Hit::Kind::missed;
}

}  // namespace cleave::topology::detail
