#include <algorithm>
#include <cmath>
#include <map>
#include <span>
#include <tuple>
#include <utility>

#include "cleave/core/assert.hpp"
#include "cleave/core/disjoint_sets.hpp"
#include "cleave/exchange/polygons.hpp"

namespace cleave::report::detail {
namespace {

using geometry::Vec3;

// One use of an edge by a polygon, from corner `corner` (numbered through all polygons) to the next one.
struct Use {
  std::uint32_t low, high;  // the edge's two points
  bool forward;             // from low to high
  std::size_t polygon;
  std::size_t corner, next_corner;
};

std::vector<Use> uses_of(const std::vector<Polygon>& polygons) {
  std::vector<Use> uses;
  std::size_t first = 0;
  for (std::size_t p = 0; p < polygons.size(); ++p) {
    const auto& corners = polygons[p].corners;
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const std::size_t j = (i + 1) % corners.size();
      uses.push_back({.low = std::min(corners[i], corners[j]),
                      .high = std::max(corners[i], corners[j]),
                      .forward = corners[i] < corners[j],
                      .polygon = p,
                      .corner = first + i,
                      .next_corner = first + j});
    }
    first += corners.size();
  }
  std::ranges::sort(uses, {}, [](const Use& u) { return std::tuple{u.low, u.high, !u.forward, u.corner}; });
  return uses;
}

bool same_edge(const Use& a, const Use& b) { return a.low == b.low && a.high == b.high; }

// Which side of a pinched edge stays connected: the rock's, as the cutter counts it, or the void's.
enum class Through { rock, space };

// Pairs the uses of one edge, one forward with one backward each.
std::vector<std::pair<Use, Use>> pair_up(std::vector<Use> group, const std::vector<Polygon>& polygons,
                                         std::span<const Vec3> points, Through through) {
  std::vector<std::pair<Use, Use>> pairs;
  // Diagonals of one face belong together.
  for (std::size_t i = 0; i < group.size();) {
    const auto twin = std::ranges::find_if(group, [&](const Use& u) {
      return u.forward != group[i].forward && polygons[u.polygon].face == polygons[group[i].polygon].face;
    });
    if (twin == group.end()) {
      ++i;
      continue;
    }
    const auto j = static_cast<std::size_t>(twin - group.begin());
    pairs.emplace_back(group[i], group[j]);
    group.erase(group.begin() + static_cast<std::ptrdiff_t>(std::max(i, j)));
    group.erase(group.begin() + static_cast<std::ptrdiff_t>(std::min(i, j)));
    i = 0;
  }
  if (group.empty()) return pairs;
  if (group.size() == 2) {
    pairs.emplace_back(group[0], group[1]);
    return pairs;
  }
  // By angle about the edge. Turning on from a backward use leads into the rock, from a forward one out of it.
  const Vec3 edge = points[group.front().high] - points[group.front().low];
  // An edge may be shorter than doubles can tell: then any direction serves, the points fall together whatever the
  // pairs.
  const Vec3 along = norm(edge) > 0 ? normalized(edge) : Vec3{0, 0, 1};
  const auto into_face = [&](const Use& u) { return cross(polygons[u.polygon].outward, u.forward ? along : -along); };
  const Vec3 zero = into_face(group.front()), right = cross(along, zero);
  std::vector<std::pair<double, Use>> turned;
  for (const Use& u : group) turned.emplace_back(std::atan2(dot(into_face(u), right), dot(into_face(u), zero)), u);
  std::ranges::stable_sort(turned, {}, &std::pair<double, Use>::first);
  const bool start_forward = through == Through::space;
  // Nested brackets around the circle: a stack needs two rounds at most.
  std::vector<Use> open;
  std::vector<bool> done(turned.size(), false);
  for (std::size_t k = 0; k < 2 * turned.size(); ++k) {
    const std::size_t i = k % turned.size();
    if (done[i]) continue;
    const Use& u = turned[i].second;
    if (u.forward == start_forward) {
      if (k < turned.size()) open.push_back(u);
    } else if (!open.empty()) {
      pairs.emplace_back(open.back(), u);
      open.pop_back();
      done[i] = true;
    }
  }
  return pairs;
}

bool has_pinched_edge(const std::vector<Use>& uses) {
  for (std::size_t i = 2; i < uses.size(); ++i) {
    if (same_edge(uses[i - 2], uses[i])) return true;
  }
  return false;
}

// Puts a point into the middle of an edge of a polygon; a triangle is cut in two and stays triangles, the second one
// goes to `more`.
void insert(std::vector<Polygon>& polygons, std::vector<Polygon>& more, const Use& use, std::uint32_t point) {
  Polygon& polygon = polygons[use.polygon];
  auto& corners = polygon.corners;
  const std::uint32_t from = use.forward ? use.low : use.high, towards = use.forward ? use.high : use.low;
  // A loop may pass a point twice: the edge is where both its ends are.
  std::size_t at = 0;
  while (corners[at] != from || corners[(at + 1) % corners.size()] != towards) {
    ++at;
    CLEAVE_ASSERT(at < corners.size());
  }
  if (corners.size() != 3) {
    corners.insert(corners.begin() + static_cast<std::ptrdiff_t>(at) + 1, point);
    return;
  }
  const std::uint32_t to = corners[(at + 1) % 3], third = corners[(at + 2) % 3];
  more.push_back({.corners = {point, to, third}, .outward = polygon.outward, .face = polygon.face});
  corners = {from, point, third};
}

// Gives each pair of uses of every pinched edge a middle point of its own. A triangle is cut once only: its other edges
// wait for the next round. At least the first pinched edge is gone afterwards.
void part_pinched_edges(std::vector<Polygon>& polygons, const std::vector<Use>& uses, std::vector<Vec3>& points) {
  std::vector<Polygon> halves;
  std::vector<bool> cut(polygons.size(), false);
  for (std::size_t i = 0, end = 0; i < uses.size(); i = end) {
    while (end < uses.size() && same_edge(uses[end], uses[i])) ++end;
    const std::span group = std::span{uses}.subspan(i, end - i);
    if (group.size() <= 2 || std::ranges::any_of(group, [&](const Use& u) { return cut[u.polygon]; })) continue;
    const Vec3 middle = points[group.front().low] + 0.5 * (points[group.front().high] - points[group.front().low]);
    for (const auto& [a, b] : pair_up({group.begin(), group.end()}, polygons, points, Through::rock)) {
      const auto point = static_cast<std::uint32_t>(points.size());
      points.push_back(middle);
      for (const Use& use : {a, b}) {
        cut[use.polygon] = polygons[use.polygon].corners.size() == 3;
        insert(polygons, halves, use, point);
      }
    }
  }
  polygons.insert(polygons.end(), halves.begin(), halves.end());
}

// The polygons with a point of its own for every fan at the ends of pinched edges.
std::vector<Polygon> with_doubled_points(std::vector<Polygon> polygons, const std::vector<Use>& uses,
                                         std::vector<Vec3>& points, Through through) {
  DisjointSets<> fans{uses.size()};
  std::vector<std::uint32_t> pinched;
  for (std::size_t i = 0; i < uses.size();) {
    std::size_t end = i;
    while (end < uses.size() && same_edge(uses[end], uses[i])) ++end;
    std::vector<Use> group(uses.begin() + static_cast<std::ptrdiff_t>(i),
                           uses.begin() + static_cast<std::ptrdiff_t>(end));
    if (group.size() > 2) pinched.insert(pinched.end(), {group.front().low, group.front().high});
    for (const auto& [a, b] : pair_up(std::move(group), polygons, points, through)) {
      fans.join(a.corner, b.next_corner);
      fans.join(a.next_corner, b.corner);
    }
    i = end;
  }
  std::ranges::sort(pinched);
  std::map<std::pair<std::uint32_t, std::size_t>, std::uint32_t> doubles;
  std::map<std::uint32_t, std::size_t> keeps_the_point;
  std::size_t corner = 0;
  for (Polygon& polygon : polygons) {
    for (std::uint32_t& point : polygon.corners) {
      const std::size_t fan = fans.find(corner++);
      if (!std::ranges::binary_search(pinched, point)) continue;
      if (keeps_the_point.try_emplace(point, fan).first->second == fan) continue;
      const auto [found, added] = doubles.try_emplace({point, fan}, static_cast<std::uint32_t>(points.size()));
      if (added) points.push_back(points[point]);
      point = found->second;
    }
  }
  return polygons;
}

}  // namespace

void separate_pinches(std::vector<Polygon>& polygons, std::vector<Vec3>& points) {
  // A loop that passes a point twice is cut into triangles some of which are lines, there and back: they bound nothing,
  // and no middle point could ever part their two edges.
  std::erase_if(polygons, [](const Polygon& p) {
    const auto& c = p.corners;
    return c.size() == 3 && (c[0] == c[1] || c[1] == c[2] || c[2] == c[0]);
  });
  auto uses = uses_of(polygons);
  if (!has_pinched_edge(uses)) return;
  const std::size_t before = points.size();
  for (const Through through : {Through::rock, Through::space}) {
    auto doubled = with_doubled_points(polygons, uses, points, through);
    if (!has_pinched_edge(uses_of(doubled))) {
      polygons = std::move(doubled);
      return;
    }
    points.resize(before);
  }
  // Both ends of some edge are one fan each however its uses are paired: each pair gets a middle point of its own.
  polygons = with_doubled_points(std::move(polygons), uses, points, Through::rock);
  for (uses = uses_of(polygons); has_pinched_edge(uses); uses = uses_of(polygons)) {
    part_pinched_edges(polygons, uses, points);
  }
}

}  // namespace cleave::report::detail
