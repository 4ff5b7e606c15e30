#include "detail/holes.hpp"

#include <algorithm>

namespace cleave::topology::detail {
namespace {

using exact::LatticePoint;
using exact::Sign;
using Loop = std::vector<LatticePoint>;

/// Whether the open segments a b and c d have a point in common, or one holds an end of the other inside.
bool in_the_way(LatticePoint a, LatticePoint b, LatticePoint c, LatticePoint d, LatticePoint along) {
  if (a == c || a == d || b == c || b == d) {
    // They share an end: in the way only where they lie on one another.
    const LatticePoint shared = a == c || a == d ? a : b;
    const LatticePoint mine = shared == a ? b : a, theirs = shared == c ? d : c;
    if (orient2d(shared, mine, theirs, along) != Sign::zero) return false;
    const LatticePoint u = mine - shared, v = theirs - shared;
    const double dot = static_cast<double>(u.x) * static_cast<double>(v.x) +
                       static_cast<double>(u.y) * static_cast<double>(v.y) +
                       static_cast<double>(u.z) * static_cast<double>(v.z);
    return dot > 0;
  }
  const Sign c1 = orient2d(a, b, c, along), d1 = orient2d(a, b, d, along), a1 = orient2d(c, d, a, along),
             b1 = orient2d(c, d, b, along);
  const auto apart = [](Sign x, Sign y) { return x == y && x != Sign::zero; };
  if (apart(c1, d1) || apart(a1, b1)) return false;
  if (c1 == Sign::zero && d1 == Sign::zero) {  // on one line: ends between ends?
    const auto between = [](LatticePoint p, LatticePoint q, LatticePoint r) {
      const auto within = [](std::int64_t x, std::int64_t y, std::int64_t z) {
        return std::min(x, y) <= z && z <= std::max(x, y);
      };
      return within(p.x, q.x, r.x) && within(p.y, q.y, r.y) && within(p.z, q.z, r.z);
    };
    return between(a, b, c) || between(a, b, d) || between(c, d, a);
  }
  return true;
}

bool blocked(LatticePoint a, LatticePoint b, const Loop& loop, LatticePoint along) {
  for (std::size_t i = 0; i < loop.size(); ++i) {
    if (in_the_way(a, b, loop[i], loop[(i + 1) % loop.size()], along)) return true;
  }
  return false;
}

/// Whether the direction from ring[k] to `to` leads into the ring's inside.
bool inwards(const Loop& ring, std::size_t k, LatticePoint to, LatticePoint along) {
  const LatticePoint before = ring[(k + ring.size() - 1) % ring.size()], at = ring[k],
                     after = ring[(k + 1) % ring.size()];
  const bool left_of_in = orient2d(before, at, to, along) == Sign::positive;
  const bool left_of_out = orient2d(at, after, to, along) == Sign::positive;
  return orient2d(before, at, after, along) == Sign::positive ? left_of_in && left_of_out : left_of_in || left_of_out;
}

/// Twice the signed area as seen along -along, up to a positive factor; rounded, for choosing the sense of a loop only.
Sign sense_of(const Loop& loop, LatticePoint along) {
  // The corner that is extreme in some direction turns the way the whole loop does.
  std::size_t extreme = 0;
  for (std::size_t i = 1; i < loop.size(); ++i) {
    if (loop[i] < loop[extreme]) extreme = i;
  }
  const std::size_t count = loop.size();
  return orient2d(loop[(extreme + count - 1) % count], loop[extreme], loop[(extreme + 1) % count], along);
}

}  // namespace

bool tidy_holes(std::vector<Loop>& holes, LatticePoint along) {
  for (Loop& hole : holes) {
    // Without corners inside straight sides, and clockwise.
    for (bool changed = true; changed && hole.size() >= 3;) {
      changed = false;
      for (std::size_t i = 0; i < hole.size(); ++i) {
        const std::size_t count = hole.size();
        if (orient2d(hole[(i + count - 1) % count], hole[i], hole[(i + 1) % count], along) != Sign::zero) continue;
        hole.erase(hole.begin() + static_cast<std::ptrdiff_t>(i));
        changed = true;
        break;
      }
    }
    if (hole.size() < 3) return false;
    const Sign sense = sense_of(hole, along);
    if (sense == Sign::zero) return false;
    if (sense == Sign::positive) std::ranges::reverse(hole);
  }
  return true;
}

std::vector<std::array<LatticePoint, 3>> triangulate_with_holes(const LatticePolygon& polygon,
                                                                std::vector<Loop> holes) {
  const LatticePoint along = polygon.along;
  if (!tidy_holes(holes, along)) return {};
  Loop ring = polygon.corners;
  // Each hole is joined to the ring by a bridge that nothing is in the way of; there always is one for some hole.
  while (!holes.empty()) {
    bool joined = false;
    for (std::size_t h = 0; h < holes.size() && !joined; ++h) {
      for (std::size_t i = 0; !joined && i < holes[h].size(); ++i) {
        for (std::size_t k = 0; k < ring.size() && !joined; ++k) {
          const LatticePoint from = ring[k], to = holes[h][i];
          if (from == to || !inwards(ring, k, to, along) || blocked(from, to, ring, along)) continue;
          if (std::ranges::any_of(holes, [&](const Loop& other) { return blocked(from, to, other, along); })) continue;
          Loop bridge;
          for (std::size_t n = 0; n <= holes[h].size(); ++n) bridge.push_back(holes[h][(i + n) % holes[h].size()]);
          bridge.push_back(from);
          ring.insert(ring.begin() + static_cast<std::ptrdiff_t>(k) + 1, bridge.begin(), bridge.end());
          holes.erase(holes.begin() + static_cast<std::ptrdiff_t>(h));
          joined = true;
        }
      }
    }
    if (!joined) return {};
  }
  LatticePolygon whole = polygon;
  whole.corners = std::move(ring);
  std::vector<std::array<LatticePoint, 3>> out;
  for (const auto& [a, b, c] : triangulate(whole))
    out.push_back({whole.corners[a], whole.corners[b], whole.corners[c]});
  return out;
}

}  // namespace cleave::topology::detail
