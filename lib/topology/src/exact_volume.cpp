#include "detail/exact_volume.hpp"

#include "cleave/core/assert.hpp"
#include "detail/rational_point.hpp"

namespace cleave::topology::detail {

RationalPoint rational_position(const Prepared& prepared, const Meet& planes) {
  const auto meet = exact::exact_meet(exact::exact_line(prepared.planes[planes[0]], prepared.planes[planes[1]]),
                                      prepared.planes[planes[2]]);
  // The rational type takes no negative denominator.
  const bool negative = meet.w < 0;
  const auto positive = [negative](const exact::Int512& value) {
    return boost::multiprecision::cpp_int{negative ? exact::Int512{-value} : value};
  };
  const boost::multiprecision::cpp_int w = positive(meet.w);
  RationalPoint p;
  for (std::size_t k = 0; k < 3; ++k) p[k] = Rational{positive(meet.x[k]), w};
  return p;
}

namespace {

Rational determinant(const RationalPoint& a, const RationalPoint& b, const RationalPoint& c) {
  return a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0]);
}

}  // namespace

void ExactMeasures::for_each_triangle(Index half_face, const auto& visit) const {
  const PlaneFace& face = arrangement_.faces[half_face / 2];
  const Index apex = arrangement_.start[arrangement_.loops[face.first_loop]];
  for (Index l = face.first_loop; l < face.first_loop + face.loop_count; ++l) {
    const Index start = arrangement_.loops[l];
    Index h = start;
    do {
      const Index a = arrangement_.start[h];
      h = arrangement_.next[h];
      const Index b = arrangement_.start[h];
      if (a == apex || b == apex) continue;
      // The positive half-face sees its cell on the side of the normal: the outward normal is the other way.
      if (half_face % 2 == 0) {
        visit(apex, b, a);
      } else {
        visit(apex, a, b);
      }
    } while (h != start);
  }
}

const exact::FixedPoint& ExactMeasures::point(Index vertex) {
  const auto [entry, added] = points_.try_emplace(vertex);
  if (added) {
    const auto& planes = graph_.meet(vertex);
    const auto meet =
        exact::fixed_meet(prepared_.planes[planes[0]], prepared_.planes[planes[1]], prepared_.planes[planes[2]]);
    CLEAVE_ASSERT(meet.has_value());
    entry->second = *meet;
  }
  return entry->second;
}

FixedMeasure ExactMeasures::measure(std::span<const Index> half_faces) {
  const Index first = arrangement_.loops[arrangement_.faces[half_faces.front() / 2].first_loop];
  FixedMeasure measure{point(arrangement_.start[first])};
  for (const Index half_face : half_faces) add(measure, half_face);
  return measure;
}

void ExactMeasures::add(FixedMeasure& measure, Index half_face) {
  for_each_triangle(half_face, [&](Index a, Index b, Index c) { measure.add(point(a), point(b), point(c)); });
}

exact::Sign ExactMeasures::sign(std::span<const Index> half_faces) {
  if (const auto sign = measure(half_faces).sign()) return *sign;
  // Thinner than 2^-64 of a site, or flat: rationals, whose denominators grow with the number of corners.
  Rational six_volumes = 0;
  for (const Index half_face : half_faces) {
    for_each_triangle(half_face, [&](Index a, Index b, Index c) {
      six_volumes +=
          determinant(rational_position(prepared_, graph_.meet(a)), rational_position(prepared_, graph_.meet(b)),
                      rational_position(prepared_, graph_.meet(c)));
    });
  }
  return exact::sign_of(six_volumes);
}

}  // namespace cleave::topology::detail
