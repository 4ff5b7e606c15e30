#include <algorithm>
#include <cmath>
#include <numbers>

#include "cleave/geometry/tunnel.hpp"
#include "cleave/stability/support.hpp"

namespace cleave::stability {
namespace {

using geometry::norm;
using geometry::normalized;
using geometry::Vec3;

struct Arc {
  struct Edge {
    std::array<double, 2> from, to;
    double length;
  };
  std::vector<Edge> edges;
  double length = 0;
  bool closed = false;  ///< all of the outline
};

/// The outline's edges within the arc, in order, beginning after one that is not.
Arc arc_of(const RingPattern& pattern) {
  const auto& outline = pattern.outline;
  const std::size_t n = outline.size();
  std::vector<bool> kept(n);
  for (std::size_t i = 0; i < n; ++i) {
    const auto& a = outline[i];
    const auto& b = outline[(i + 1) % n];
    // Outward normal of a counter-clockwise outline: (dv, -du).
    const double angle = std::atan2(b[1] - a[1], -(b[0] - a[0])) * 180 / std::numbers::pi;
    kept[i] = angle >= pattern.arc[0] - 1e-9 && angle <= pattern.arc[1] + 1e-9;
  }
  std::size_t start = 0;
  for (std::size_t i = 0; i < n; ++i) {
    if (kept[i] && !kept[(i + n - 1) % n]) start = i;
  }
  Arc arc;
  for (std::size_t k = 0; k < n; ++k) {
    const std::size_t i = (start + k) % n;
    if (!kept[i]) continue;
    const auto& a = outline[i];
    const auto& b = outline[(i + 1) % n];
    arc.edges.push_back({a, b, std::hypot(b[0] - a[0], b[1] - a[1])});
    arc.length += arc.edges.back().length;
  }
  arc.closed = arc.edges.size() == n;
  return arc;
}

/// A spacing that divides the length is meant to.
double rounding(double length) { return 1e-9 * std::max(1.0, length); }

std::size_t count(double length, double offset, double spacing) {
  const double room = length - offset + rounding(length);
  constexpr double most = 1e9;
  return room < 0 ? 0 : static_cast<std::size_t>(std::min(most, std::floor(room / spacing))) + 1;
}

/// Of a ring. All round the last bolt must not stand where the first one does.
std::size_t count(const Arc& arc, double offset, double spacing) {
  const std::size_t all = count(arc.length, offset, spacing);
  const bool meets =
      arc.closed && all > 1 && static_cast<double>(all - 1) * spacing > arc.length - rounding(arc.length);
  return meets ? all - 1 : all;
}

bool is_pattern(const RingPattern& pattern) {
  return pattern.along > metres(0) && pattern.around > metres(0) && pattern.axis.size() >= 2 &&
         pattern.outline.size() >= 3;
}

std::size_t rings_of(const RingPattern& pattern) {
  double total = 0;
  for (std::size_t i = 0; i + 1 < pattern.axis.size(); ++i) total += norm(pattern.axis[i + 1] - pattern.axis[i]);
  return count(total, pattern.offset_along.si(), pattern.along.si());
}

/// Of `all` rings or rows as many as are staggered, or are not, with this many bolts each.
std::uint64_t sum_of(std::size_t all, std::size_t in_even, std::size_t in_odd) {
  const std::uint64_t odd = all / 2, even = all - odd;
  return even * in_even + odd * in_odd;
}

}  // namespace

std::uint64_t number_of_bolts(const RingPattern& pattern) {
  if (!is_pattern(pattern)) return 0;
  const Arc arc = arc_of(pattern);
  if (arc.edges.empty()) return 0;
  const double shift = pattern.stagger ? 0.5 * pattern.around.si() : 0;
  return sum_of(rings_of(pattern), count(arc, pattern.offset_around.si(), pattern.around.si()),
                count(arc, pattern.offset_around.si() + shift, pattern.around.si()));
}

std::uint64_t number_of_bolts(const GridPattern& pattern) {
  if (!(pattern.spacing_across > metres(0)) || !(pattern.spacing_down > metres(0))) return 0;
  const double shift = pattern.stagger ? 0.5 * pattern.spacing_across.si() : 0;
  return sum_of(count(pattern.height.si(), pattern.offset_down.si(), pattern.spacing_down.si()),
                count(pattern.width.si(), pattern.offset_across.si(), pattern.spacing_across.si()),
                count(pattern.width.si(), pattern.offset_across.si() + shift, pattern.spacing_across.si()));
}

std::vector<Bolt> bolts_of(const RingPattern& pattern) {
  std::vector<Bolt> bolts;
  if (!is_pattern(pattern)) return bolts;
  const Arc arc = arc_of(pattern);
  if (arc.edges.empty()) return bolts;
  const std::vector<geometry::SectionFrame> frames = geometry::section_frames(pattern.axis, pattern.up);
  const std::size_t rings = rings_of(pattern);
  const double tilt = pattern.inclination * std::numbers::pi / 180;
  for (std::size_t ring = 0; ring < rings; ++ring) {
    double station = (pattern.offset_along + static_cast<double>(ring) * pattern.along).si();
    std::size_t leg = 0;
    while (leg + 2 < pattern.axis.size() && station > norm(pattern.axis[leg + 1] - pattern.axis[leg])) {
      station -= norm(pattern.axis[leg + 1] - pattern.axis[leg]);
      ++leg;
    }
    const auto& [ahead, right, up] = frames[leg];
    const Vec3 centre = pattern.axis[leg] + station * ahead;
    const double shift = pattern.stagger && ring % 2 == 1 ? 0.5 * pattern.around.si() : 0;
    const std::size_t in_ring = count(arc, pattern.offset_around.si() + shift, pattern.around.si());
    for (std::size_t k = 0; k < in_ring; ++k) {
      double s = pattern.offset_around.si() + shift + static_cast<double>(k) * pattern.around.si();
      std::size_t e = 0;
      while (e + 1 < arc.edges.size() && s > arc.edges[e].length) s -= arc.edges[e++].length;
      const Arc::Edge& edge = arc.edges[e];
      const double share = std::min(1.0, s / edge.length);
      const double du = edge.to[0] - edge.from[0], dv = edge.to[1] - edge.from[1];
      const Vec3 collar = centre + (edge.from[0] + share * du) * right + (edge.from[1] + share * dv) * up;
      const Vec3 normal = normalized(dv * right - du * up);
      bolts.push_back({.collar = collar,
                       .direction = normalized(std::cos(tilt) * normal + std::sin(tilt) * ahead),
                       .length = pattern.length,
                       .type = pattern.type,
                       .group = pattern.group,
                       .after_stage = pattern.after_stage});
    }
  }
  return bolts;
}

std::vector<Bolt> bolts_of(const GridPattern& pattern) {
  std::vector<Bolt> bolts;
  if (!(pattern.spacing_across > metres(0)) || !(pattern.spacing_down > metres(0))) return bolts;
  const std::size_t rows = count(pattern.height.si(), pattern.offset_down.si(), pattern.spacing_down.si());
  for (std::size_t row = 0; row < rows; ++row) {
    const double y = (pattern.offset_down + static_cast<double>(row) * pattern.spacing_down).si();
    const double shift =
        pattern.offset_across.si() + (pattern.stagger && row % 2 == 1 ? 0.5 * pattern.spacing_across.si() : 0);
    const std::size_t columns = count(pattern.width.si(), shift, pattern.spacing_across.si());
    for (std::size_t column = 0; column < columns; ++column) {
      const double x = shift + static_cast<double>(column) * pattern.spacing_across.si();
      bolts.push_back({.collar = pattern.corner + x * pattern.across + y * pattern.down,
                       .direction = pattern.direction,
                       .length = pattern.length,
                       .type = pattern.type,
                       .group = pattern.group,
                       .after_stage = pattern.after_stage});
    }
  }
  return bolts;
}

}  // namespace cleave::stability
