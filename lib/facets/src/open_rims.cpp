#include "detail/open_rims.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "cleave/geometry/box_tree.hpp"
#include "cleave/geometry/vec3.hpp"
#include "detail/as_vec3.hpp"
#include "detail/side_users.hpp"

namespace cleave::topology::detail {
namespace {

using exact::LatticePoint;
using geometry::Vec3;

struct OpenSide {
  std::size_t polygon;
  LatticePoint from, to;
  Vec3 p, q;  ///< what is left of it in the domain
};

/// Sites from a segment.
double off(Vec3 p, Vec3 q, Vec3 point) {
  const Vec3 side = q - p, to = point - p;
  const double square = dot(side, side);
  return geometry::norm(to - (square > 0 ? std::clamp(dot(to, side) / square, 0.0, 1.0) : 0.0) * side);
}

std::vector<OpenSide> open_sides(std::span<const JointPolygon> polygons, const std::vector<std::uint8_t>& left_out,
                                 const SharedCorners& shared, const Prepared& prepared) {
  std::vector<OpenSide> open;
  for (std::size_t k = 0; k < polygons.size(); ++k) {
    if (left_out[k] != 0) continue;
    bool any_shared = false;
    const std::size_t before = open.size();
    SideUsers::for_each_side(polygons[k], [&](LatticePoint a, LatticePoint b) {
      if (shared.shared(a, b)) {
        any_shared = true;
        return;
      }
      OpenSide side{k, a, b, as_vec3(a), as_vec3(b)};
      if (clip_to_domain(prepared, side.p, side.q)) open.push_back(side);
    });
    if (!any_shared) open.erase(open.begin() + static_cast<std::ptrdiff_t>(before), open.end());
  }
  return open;
}

}  // namespace

bool clip_to_domain(const Prepared& prepared, Vec3& p, Vec3& q) {
  for (const HalfSpace& side : prepared.clip) {
    const auto& n = prepared.planes[side.plane].approx();
    const auto height = [&](Vec3 at) {
      const double above = n[0] * at.x + n[1] * at.y + n[2] * at.z + std::ldexp(n[3], 48);
      return side.inside_positive ? above : -above;
    };
    const double at_p = height(p), at_q = height(q);
    if (at_p >= 0 && at_q >= 0) continue;
    if (at_p <= 0 && at_q <= 0) return false;
    (at_p < at_q ? p : q) = p + (at_p / (at_p - at_q)) * (q - p);
  }
  return true;
}

NearMisses find_open_rims(std::span<const JointPolygon> polygons, const std::vector<std::uint8_t>& left_out,
                          const std::vector<std::optional<exact::Plane>>& sheets, const SharedCorners& shared,
                          const Prepared& prepared, double limit_sites) {
  NearMisses found;
  if (!shared.any_side()) return found;
  const std::vector<OpenSide> open = open_sides(polygons, left_out, shared, prepared);
  if (open.size() < 2) return found;
  std::vector<geometry::Box> boxes;
  for (const OpenSide& side : open) boxes.push_back(geometry::box_of(std::array{side.p, side.q}).grown(limit_sites));
  const auto on_one_sheet = [&](std::size_t a, std::size_t b) {
    return sheets[a] && sheets[b] && sheets[a]->coincides_with(*sheets[b]);
  };
  double largest = 0;
  const geometry::BoxTree tree{boxes};
  for (std::size_t i = 0; i < open.size(); ++i) {
    const OpenSide& a = open[i];
    tree.overlapping(boxes[i], [&](std::uint32_t j) {
      const OpenSide& b = open[j];
      if (j <= i || a.polygon == b.polygon) return;
      const bool meet = a.from == b.from || a.from == b.to || a.to == b.from || a.to == b.to;
      if (!meet && !on_one_sheet(a.polygon, b.polygon)) return;
      const double of_a = std::max(off(b.p, b.q, a.p), off(b.p, b.q, a.q));
      const double of_b = std::max(off(a.p, a.q, b.p), off(a.p, a.q, b.q));
      const double gap = std::min(of_a, of_b);
      const double shorter = std::min(geometry::norm(a.q - a.p), geometry::norm(b.q - b.p));
      if (!(gap > 0) || gap > limit_sites || gap > shorter / 4) return;
      ++found.sides;
      const JointId first{std::min(polygons[a.polygon].joint, polygons[b.polygon].joint)};
      const JointId second{std::max(polygons[a.polygon].joint, polygons[b.polygon].joint)};
      const auto names = std::pair{found.joint, found.other.value_or(found.joint)};
      if (gap < largest || (!(gap > largest) && names <= std::pair{first, second})) return;
      largest = gap;
      found.largest = metres(gap * prepared.lattice.pitch());
      found.joint = first;
      found.other = second;
    });
  }
  return found;
}

}  // namespace cleave::topology::detail
