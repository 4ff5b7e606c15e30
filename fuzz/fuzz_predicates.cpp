/// Four planes through lattice points made of bytes, degenerate on purpose: what the filter decides must be what the
/// integers say, and both must be what Cramer's rule says in integers without bound.

#include <array>
#include <vector>

#include "byte_source.hpp"
#include "cleave/core/assert.hpp"
#include "cleave/exact/predicates.hpp"
#include "fuzz_target.hpp"
#include "keep_readable.hpp"
#include "plane_reference.hpp"

namespace cleave {
namespace {

using exact::LatticePoint;
using exact::Plane;
using exact::Sign;

/// Points are drawn anew, taken from those before, or moved from one of them by a site or two.
class Points final {
 public:
  explicit Points(support::ByteSource& source) : source_{source} {}
  LatticePoint next() {
    constexpr std::int64_t reach = std::int64_t{1} << 47;
    LatticePoint p;
    switch (earlier_.empty() ? source_.up_to(1) : source_.up_to(3)) {
      case 0: p = point(4); break;
      case 1: p = point(reach); break;
      case 2: p = earlier_[source_.up_to(earlier_.size() - 1)]; break;
      default: p = earlier_[source_.up_to(earlier_.size() - 1)] + point(1); break;
    }
    for (std::int64_t* c : {&p.x, &p.y, &p.z}) {
      if (*c > reach) *c = reach;
      if (*c < -reach) *c = -reach;
    }
    earlier_.push_back(p);
    return p;
  }

 private:
  LatticePoint point(std::int64_t reach) {
    const auto x = source_.between(-reach, reach), y = source_.between(-reach, reach),
               z = source_.between(-reach, reach);
    return {x, y, z};
  }
  support::ByteSource& source_;
  std::vector<LatticePoint> earlier_;
};

void check(const Plane& p, const Plane& q, const Plane& r, const Plane& s) {
  const auto line = exact::line_of(p, q);
  const auto point = exact::meet(line, r);
  const Sign orientation = exact::det3_exact(p, q, r);
  CLEAVE_ASSERT(orientation == testing::sign(testing::det3(p, q, r)));
  CLEAVE_ASSERT(exact::orientation(p, q, r) == orientation);
  const auto filtered = exact::det3_filtered(point);
  CLEAVE_ASSERT(!filtered || *filtered == orientation);
  if (orientation == Sign::zero) {
    if (!p.parallel_to(q)) {
      CLEAVE_ASSERT(exact::side_of_parallel_line(p, q, r.flipped()) == -exact::side_of_parallel_line(p, q, r));
    }
    return;
  }
  const Sign side = exact::side_exact(p, q, r, s);
  CLEAVE_ASSERT(side == testing::side_reference(p, q, r, s));
  CLEAVE_ASSERT(side == exact::side_exact(q, p.flipped(), r, s));
  const auto side_filtered = exact::side_filtered(point, s);
  CLEAVE_ASSERT(!side_filtered || *side_filtered == side);
}

}  // namespace
}  // namespace cleave

CLEAVE_FUZZ_TARGET(bytes) {
  using namespace cleave;
  support::ByteSource source{bytes};
  Points points{source};
  std::vector<Plane> planes;
  std::string text;
  for (int i = 0; i < 4; ++i) {
    const LatticePoint a = points.next(), b = points.next(), c = points.next();
    for (const LatticePoint p : {a, b, c}) {
      text += std::to_string(p.x) + ' ' + std::to_string(p.y) + ' ' + std::to_string(p.z) + '\n';
    }
    const auto plane = Plane::through(a, b, c);
    if (!plane) continue;
    for (const LatticePoint p : {a, b, c}) CLEAVE_ASSERT(plane->side_of(p) == Sign::zero);
    planes.push_back(*plane);
  }
  support::keep_readable([&] { return text; });
  if (planes.size() < 3) return;
  for (std::size_t k = 0; k < planes.size(); ++k) {
    const std::size_t n = planes.size();
    check(planes[k], planes[(k + 1) % n], planes[(k + 2) % n], planes[(k + 3) % n]);
  }
}
