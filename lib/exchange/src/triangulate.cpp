#include "cleave/exchange/triangulate.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <tuple>
#include <utility>

#include "cleave/geometry/ear_ring.hpp"
#include "cleave/geometry/predicates.hpp"

namespace cleave::report {
namespace {

// 1 when c lies to the left of a -> b, -1 to the right, 0 on the line; exact.
int orient(Vec2 a, Vec2 b, Vec2 c) { return static_cast<int>(geometry::orient2d(a, b, c)); }

// Seen from outside along the largest axis of the normal: a plain choice of two coordinates, nothing is rounded.
Vec2 seen(geometry::Vec3 p, geometry::Vec3 outward) {
  const double x = std::abs(outward.x), y = std::abs(outward.y), z = std::abs(outward.z);
  if (z >= x && z >= y) return outward.z > 0 ? Vec2{p.x, p.y} : Vec2{p.y, p.x};
  if (x >= y) return outward.x > 0 ? Vec2{p.y, p.z} : Vec2{p.z, p.y};
  return outward.y > 0 ? Vec2{p.z, p.x} : Vec2{p.x, p.z};
}

// A corner of the polygon that is being clipped: one passage of a loop through a vertex.
struct Node {
  std::uint32_t vertex;
  Vec2 at;
  std::size_t previous, next;
};

class Clipper {
 public:
  Clipper(std::span<const std::vector<std::uint32_t>> loops, std::span<const geometry::Vec3> positions,
          geometry::Vec3 outward) {
    for (const auto& loop : loops) {
      const std::size_t first = nodes_.size();
      for (std::size_t i = 0; i < loop.size(); ++i) {
        nodes_.push_back({.vertex = loop[i],
                          .at = seen(positions[loop[i]], outward),
                          .previous = first + (i + loop.size() - 1) % loop.size(),
                          .next = first + (i + 1) % loop.size()});
      }
      firsts_.push_back(first);
    }
  }

  std::vector<Triangle> run() {
    join_holes();
    clip();
    return std::move(triangles_);
  }

  // For EarRing: corners are nodes.
  exact::Sign turn(std::size_t i, std::size_t j, std::size_t k) const {
    return geometry::orient2d(nodes_[i].at, nodes_[j].at, nodes_[k].at);
  }
  // What lies in the place of a corner, or outside of the box around the ear, which is cheap to see.
  auto ignored(std::size_t i, std::size_t j, std::size_t k) const {
    const Vec2 a = nodes_[i].at, b = nodes_[j].at, c = nodes_[k].at;
    Box2 box;
    for (const Vec2 p : {a, b, c}) box.add(p);
    return [this, a, b, c, box](std::size_t n) {
      const Vec2 p = nodes_[n].at;
      return p.x < box.low.x || p.x > box.high.x || p.y < box.low.y || p.y > box.high.y || p == a || p == b || p == c;
    };
  }

 private:
  // Does the direction from corner `a` to `p` lead into the polygon there? (O'Rourke 1998, InCone, open cone)
  static bool opens_to(Vec2 before, Vec2 a, Vec2 after, Vec2 p) {
    if (orient(before, a, after) > 0) return orient(before, a, p) > 0 && orient(a, after, p) > 0;
    return orient(before, a, p) > 0 || orient(a, after, p) > 0;
  }
  bool opens_to(std::size_t n, Vec2 p) const {
    return opens_to(nodes_[nodes_[n].previous].at, nodes_[n].at, nodes_[nodes_[n].next].at, p);
  }

  // Closed segments; exact, and cheap where they are far apart.
  static bool cross(Vec2 a, Vec2 b, Vec2 c, Vec2 d) {
    if (std::max(c.x, d.x) < std::min(a.x, b.x) || std::max(a.x, b.x) < std::min(c.x, d.x) ||
        std::max(c.y, d.y) < std::min(a.y, b.y) || std::max(a.y, b.y) < std::min(c.y, d.y)) {
      return false;
    }
    const int c_side = orient(a, b, c), d_side = orient(a, b, d);
    if (c_side == 0 && d_side == 0) return false;  // on one line: the corners in between are tested by `blocked`
    return c_side * d_side <= 0 && orient(c, d, a) * orient(c, d, b) <= 0;
  }

  static bool between(Vec2 a, Vec2 b, Vec2 p) {
    return (a.x != b.x ? (a.x < p.x) != (b.x < p.x) : (a.y < p.y) != (b.y < p.y)) && orient(a, b, p) == 0 && p != a &&
           p != b;
  }

  // Does anything stand between the nodes m and n? Edges that end in one of the two places do not count.
  bool blocked(std::size_t m, std::size_t n) const {
    const Node& a = nodes_[m];
    const Node& b = nodes_[n];
    for (const Node& c : nodes_) {
      const Node& d = nodes_[c.next];
      if (between(a.at, b.at, c.at)) return true;
      if (c.at == a.at || c.at == b.at || d.at == a.at || d.at == b.at) continue;
      if (cross(a.at, b.at, c.at, d.at)) return true;
    }
    return false;
  }

  // Joins the loop of node m to the polygon's node n by a bridge, walked once in each direction; by nothing when both
  // are one vertex.
  void join(std::size_t m, std::size_t n) {
    const std::size_t m_before = nodes_[m].previous;
    const std::size_t n_after = nodes_[n].next;
    if (nodes_[m].vertex == nodes_[n].vertex) {
      // Two passages of one vertex: ... n -> (rest of hole) -> m -> n_after ...
      const std::size_t hole_after = nodes_[m].next;
      link(n, hole_after);
      link(m, n_after);
      return;
    }
    const std::size_t m_twin = nodes_.size(), n_twin = m_twin + 1;
    nodes_.push_back(nodes_[m]);
    nodes_.push_back(nodes_[n]);
    link(n, m);
    link(m_before, m_twin);
    link(m_twin, n_twin);
    link(n_twin, n_after);
  }

  void link(std::size_t from, std::size_t to) {
    nodes_[from].next = to;
    nodes_[to].previous = from;
  }

  std::vector<std::size_t> ring(std::size_t first) const {
    std::vector<std::size_t> nodes{first};
    for (std::size_t n = nodes_[first].next; n != first; n = nodes_[n].next) nodes.push_back(n);
    return nodes;
  }

  // The node of `outer` in the same place as m (the same vertex, or a double of it) that opens to the hole's two edges
  // there.
  std::optional<std::size_t> touching(const std::vector<std::size_t>& outer, std::size_t m) const {
    for (const std::size_t n : outer) {
      if (nodes_[n].at == nodes_[m].at && opens_to(n, nodes_[nodes_[m].next].at) &&
          opens_to(n, nodes_[nodes_[m].previous].at)) {
        return n;
      }
    }
    return std::nullopt;
  }

  // Holes from right to left (Eberly 2002): the rightmost corner of a hole sees a corner of what is joined already.
  void join_holes() {
    struct Hole {
      std::size_t first, rightmost;
    };
    std::vector<Hole> holes;
    for (std::size_t loop = 1; loop < firsts_.size(); ++loop) {
      const auto nodes = ring(firsts_[loop]);
      const auto right = std::ranges::max_element(
          nodes, {}, [&](std::size_t n) { return std::tuple{nodes_[n].at.x, nodes_[n].at.y}; });
      holes.push_back({.first = firsts_[loop], .rightmost = *right});
    }
    std::ranges::stable_sort(holes, std::ranges::greater{}, [&](const Hole& h) {
      return std::tuple{nodes_[h.rightmost].at.x, nodes_[h.rightmost].at.y};
    });
    for (const Hole& hole : holes) join_hole(hole.first, hole.rightmost);
  }

  void join_hole(std::size_t first, std::size_t rightmost) {
    const auto outer = ring(firsts_.front());
    for (const std::size_t m : ring(first)) {
      if (const auto n = touching(outer, m)) return join(m, *n);
    }
    const Vec2 from = nodes_[rightmost].at;
    std::vector<std::pair<double, std::size_t>> nearest;
    nearest.reserve(outer.size());
    for (const std::size_t n : outer) {
      const double du = nodes_[n].at.x - from.x, dv = nodes_[n].at.y - from.y;
      nearest.emplace_back(du * du + dv * dv, n);
    }
    std::ranges::sort(nearest);
    for (const auto& [distance, n] : nearest) {
      if (opens_to(n, from) && opens_to(rightmost, nodes_[n].at) && !blocked(rightmost, n)) return join(rightmost, n);
    }
    // Only positions that were rounded into a crossing get here: any bridge keeps the edges paired.
    join(rightmost, nearest.front().second);
  }

  // Neighbours that look into the polygon along the new edge, which is one.
  bool is_open(const geometry::EarRing<Clipper>& ring, std::size_t k) const {
    if (ring.turn(k) != exact::Sign::positive) return false;
    const auto [a, b, c] = ring.triangle(k);
    const Vec2 from = nodes_[a].at, to = nodes_[c].at;
    const std::size_t count = ring.size(), before = k == 0 ? count - 1 : k - 1, after = k + 1 == count ? 0 : k + 1;
    return from != to && opens_to(nodes_[ring.before(before)].at, from, nodes_[b].at, to) &&
           opens_to(nodes_[b].at, to, nodes_[ring.after(after)].at, from);
  }

  void clip() {
    geometry::EarRing<Clipper> left{ring(firsts_.front()), *this};
    const auto add = [&](const std::array<std::size_t, 3>& ear) {
      triangles_.push_back({nodes_[ear[0]].vertex, nodes_[ear[1]].vertex, nodes_[ear[2]].vertex});
    };
    std::size_t from = 0;
    while (left.size() > 3) {
      auto k = left.find(from, [&](std::size_t place) { return is_open(left, place) && left.is_ear(place); });
      if (!k) k = left.find(from, [&](std::size_t place) { return left.turn(place) == exact::Sign::zero; });
      if (!k) k = left.find(from, [&](std::size_t place) { return is_open(left, place); });
      if (!k) k = from % left.size();
      add(left.cut(*k));
      from = *k + 1;  // not the neighbour: fans of slivers are avoided
    }
    add(left.triangle(from % left.size()));
  }

  std::vector<Node> nodes_;
  std::vector<std::size_t> firsts_;
  std::vector<Triangle> triangles_;
};

using Loop = std::vector<std::uint32_t>;
using Region = std::vector<Loop>;  // [0] outline, then its holes; each passes a vertex once

// Cuts a loop where it comes back to a vertex: a figure of eight becomes two loops.
void append_simple(std::vector<Loop>& simple, const Loop& loop) {
  Loop open;
  for (const std::uint32_t vertex : loop) {
    const auto earlier = std::ranges::find(open, vertex);
    if (earlier != open.end()) {
      if (open.end() - earlier > 2) simple.emplace_back(earlier, open.end());
      open.erase(earlier, open.end());
    }
    open.push_back(vertex);
  }
  if (open.size() > 2) simple.push_back(std::move(open));
}

std::vector<Vec2> seen(const Loop& loop, std::span<const geometry::Vec3> positions, geometry::Vec3 outward) {
  std::vector<Vec2> points;
  for (const std::uint32_t vertex : loop) points.push_back(seen(positions[vertex], outward));
  return points;
}

double twice_area(const std::vector<Vec2>& loop) {
  double sum = 0;
  for (std::size_t i = 1; i + 1 < loop.size(); ++i) {
    sum +=
        (loop[i].x - loop[0].x) * (loop[i + 1].y - loop[0].y) - (loop[i].y - loop[0].y) * (loop[i + 1].x - loop[0].x);
  }
  return sum;
}

std::vector<Region> regions_of(std::span<const Loop> loops, std::span<const geometry::Vec3> positions,
                               geometry::Vec3 outward) {
  std::vector<Loop> simple;
  for (const Loop& loop : loops) append_simple(simple, loop);
  std::vector<Region> regions;
  std::vector<Loop> holes;
  for (std::size_t i = 0; i < simple.size(); ++i) {
    // The outline of a face without holes is one whatever rounding made of it.
    if (simple.size() == 1 || twice_area(seen(simple[i], positions, outward)) >= 0) {
      regions.push_back({simple[i]});
    } else {
      holes.push_back(simple[i]);
    }
  }
  if (regions.empty()) {
    regions.push_back({holes.front()});
    holes.erase(holes.begin());
  }
  for (Loop& hole : holes) {
    // The smallest outline around it: there may be islands in holes.
    std::size_t home = 0;
    double smallest = std::numeric_limits<double>::infinity();
    for (std::size_t r = 0; r < regions.size() && regions.size() > 1; ++r) {
      const auto around = seen(regions[r].front(), positions, outward);
      // By majority: single corners may lie on the outline.
      std::ptrdiff_t votes = 0;
      for (const Vec2 p : seen(hole, positions, outward))
        votes += std::ranges::find(around, p) == around.end() ? (geometry::encloses(around, p) ? 1 : -1) : 0;
      if (votes <= 0 || twice_area(around) >= smallest) continue;
      smallest = twice_area(around);
      home = r;
    }
    regions[home].push_back(std::move(hole));
  }
  return regions;
}

/// Most faces are one convex loop, where every corner is an ear: the same triangles as the clipper's without asking.
/// False, and nothing done, for any other face.
bool append_convex(const Loop& loop, std::span<const geometry::Vec3> positions, geometry::Vec3 outward,
                   std::vector<Triangle>& triangles) {
  constexpr std::size_t most = 16;
  const std::size_t count = loop.size();
  if (count < 3 || count > most) return false;
  std::array<Vec2, most> at;
  for (std::size_t i = 0; i < count; ++i) at[i] = seen(positions[loop[i]], outward);
  // Left turns only, once around: directions go from left-to-right to right-to-left and back once.
  std::size_t reversals = 0;
  const auto forward = [&](std::size_t i) {
    const Vec2 a = at[i], b = at[(i + 1) % count];
    return a.x != b.x ? a.x < b.x : a.y < b.y;
  };
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t next = (i + 1) % count;
    if (orient(at[i], at[next], at[(i + 2) % count]) <= 0) return false;
    if (forward(i) != forward(next)) ++reversals;
  }
  if (reversals != 2) return false;
  std::array<std::size_t, most> previous, next;
  for (std::size_t i = 0; i < count; ++i) {
    previous[i] = (i + count - 1) % count;
    next[i] = (i + 1) % count;
  }
  std::size_t n = 0;
  for (std::size_t left = count; left > 3; --left) {
    triangles.push_back({loop[previous[n]], loop[n], loop[next[n]]});
    next[previous[n]] = next[n];
    previous[next[n]] = previous[n];
    n = next[next[n]];  // not the neighbour, as in Clipper::clip
  }
  triangles.push_back({loop[previous[n]], loop[n], loop[next[n]]});
  return true;
}

}  // namespace

std::vector<Triangle> triangulate(std::span<const std::vector<std::uint32_t>> loops,
                                  std::span<const geometry::Vec3> positions, geometry::Vec3 outward) {
  std::vector<Triangle> triangles;
  append_triangles(loops, positions, outward, triangles);
  return triangles;
}

void append_triangles(std::span<const std::vector<std::uint32_t>> loops, std::span<const geometry::Vec3> positions,
                      geometry::Vec3 outward, std::vector<Triangle>& triangles) {
  if (loops.size() == 1 && append_convex(loops.front(), positions, outward, triangles)) return;
  for (const Region& region : regions_of(loops, positions, outward)) {
    const auto part = Clipper{region, positions, outward}.run();
    triangles.insert(triangles.end(), part.begin(), part.end());
  }
}

}  // namespace cleave::report
