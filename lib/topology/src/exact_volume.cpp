#include "detail/exact_volume.hpp"

#include "cleave/exact/wide.hpp"

namespace cleave::topology::detail {
namespace {

using Rational = boost::multiprecision::cpp_rational;
using Point = std::array<Rational, 3>;

Point position(const Prepared& prepared, const Vertex& v) {
  const auto meet = exact::exact_meet(exact::exact_line(prepared.planes[v.planes[0]], prepared.planes[v.planes[1]]),
                                      prepared.planes[v.planes[2]]);
  // The rational type takes no negative denominator.
  const bool negative = meet.w < 0;
  const auto positive = [negative](const exact::Wide& value) {
    return boost::multiprecision::cpp_int{negative ? exact::Wide{-value} : value};
  };
  const boost::multiprecision::cpp_int w = positive(meet.w);
  Point p;
  for (std::size_t k = 0; k < 3; ++k) p[k] = Rational{positive(meet.x[k]), w};
  return p;
}

Rational determinant(const Point& a, const Point& b, const Point& c) {
  return a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0]);
}

}  // namespace

exact::Sign exact_volume_sign(const Prepared& prepared, const Graph& graph, const Arrangement& arrangement,
                              std::span<const Index> half_faces) {
  const auto start_of = [&](Index half_edge) -> const Vertex& {
    const Edge& edge = graph.edges[graph.uses[half_edge / 2].edge];
    return graph.vertices[half_edge % 2 == 0 ? edge.from : edge.to];
  };
  Rational six_volumes = 0;
  for (const Index half_face : half_faces) {
    const PlaneFace& face = arrangement.faces[half_face / 2];
    const Point apex = position(prepared, start_of(arrangement.loops[face.first_loop]));
    Rational part = 0;
    for (Index l = face.first_loop; l < face.first_loop + face.loop_count; ++l) {
      const Index start = arrangement.loops[l];
      Index h = start;
      Point a = position(prepared, start_of(h));
      do {
        const Index g = arrangement.next[h];
        Point b = position(prepared, start_of(g));
        part += determinant(apex, a, b);
        a = std::move(b);
        h = g;
      } while (h != start);
    }
    // The positive half-face sees its cell on the side of the normal: the outward normal is the other way.
    if (half_face % 2 == 0) {
      six_volumes -= part;
    } else {
      six_volumes += part;
    }
  }
  return exact::sign_of(six_volumes);
}

}  // namespace cleave::topology::detail
