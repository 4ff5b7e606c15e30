#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <numbers>
#include <optional>
#include <utility>

#include "cleave/core/expected.hpp"
#include "cleave/core/overloaded.hpp"
#include "cleave/geometry/orientation.hpp"
#include "cleave/geometry/polygon.hpp"
#include "cleave/geometry/tunnel.hpp"
#include "tunnel_tags.hpp"

namespace cleave::geometry {
namespace {

using Corner = std::array<double, 2>;
using Outcome = std::expected<SectionOutline, TunnelError>;

/// Name and value of a dimension that must be positive, or may be zero as well.
struct Dimension {
  const char* what;
  Length value;
  bool zero_allowed = false;
};

std::expected<void, TunnelError> check(std::initializer_list<Dimension> dimensions) {
  for (const Dimension& d : dimensions) {
    const double v = d.value.si();
    const bool ok = std::isfinite(v) && (v > 0 || (d.zero_allowed && v == 0));
    if (!ok) return std::unexpected(NonPositiveDimension{d.what, d.value});
  }
  return {};
}

/// By the outward normal: steeper than 45 degrees up is crown, down is floor.
std::uint32_t tag_of_side(Corner from, Corner to) {
  const double out_u = to[1] - from[1];
  const double out_v = from[0] - to[0];
  if (std::abs(out_v) <= std::abs(out_u) * (1 + 1e-9)) return tunnel_wall;
  return out_v > 0 ? tunnel_crown : tunnel_floor;
}

SectionOutline tagged(std::vector<Corner> corners) {
  SectionOutline outline{std::move(corners), {}};
  for (std::size_t i = 0; i < outline.corners.size(); ++i) {
    outline.tags.push_back(tag_of_side(outline.corners[i], outline.corners[(i + 1) % outline.corners.size()]));
  }
  return outline;
}

SectionOutline ellipse_outline(double half_width, double half_height, std::uint32_t segments) {
  const std::uint32_t n = 2 * segments;
  const double grown = same_area_radius(n);
  std::vector<Corner> corners;
  for (std::uint32_t i = 0; i < n; ++i) {
    const double t = 360.0 * i / n;
    corners.push_back({grown * half_width * cos_degrees(t), grown * half_height * sin_degrees(t)});
  }
  return tagged(std::move(corners));
}

/// Walls under a circular arc; rise = width / 2 makes it a half circle.
SectionOutline arched(double width, double wall, double rise, std::uint32_t segments) {
  const double half = width / 2;
  const double radius = (half * half + rise * rise) / (2 * rise);
  const bool half_circle = rise == half;
  const double spread =
      half_circle ? 90.0 : std::atan2(half, radius - rise) * (180 / std::numbers::pi);  // half the arc
  const double centre = wall + rise - radius;
  const auto n = std::max(2U, static_cast<std::uint32_t>(std::ceil(segments * spread / 90.0 - 1e-9)));
  SectionOutline outline;
  const auto side = [&](Corner from, std::uint32_t tag) {
    outline.corners.push_back({from[0], from[1] - (wall + rise) / 2});
    outline.tags.push_back(tag);
  };
  side({-half, 0}, tunnel_floor);
  if (wall > 0) side({half, 0}, tunnel_wall);
  for (std::uint32_t k = 0; k < n; ++k) {
    const double angle = 90 - spread + 2 * spread * k / n;
    side(k == 0 ? Corner{half, wall} : Corner{radius * cos_degrees(angle), centre + radius * sin_degrees(angle)},
         tunnel_crown);
  }
  if (wall > 0) side({-half, wall}, tunnel_wall);
  return outline;
}

Outcome polygon_outline(const PolygonSection& section) {
  std::vector<Vec3> flat;
  for (const auto& [u, v] : section.corners) flat.push_back({u, v, 0});
  const auto polygon = Polygon::make(std::move(flat));
  if (!polygon) return std::unexpected(BadSection{polygon.error()});
  std::vector<Corner> corners;
  double area = 0;
  const Vec3 first = polygon->corners().front();
  Box box;
  for (std::size_t i = 0; i < polygon->corners().size(); ++i) {
    const Vec3 p = polygon->corners()[i];
    area += cross(p - first, polygon->corners()[(i + 1) % polygon->corners().size()] - first).z;
    box.add(p);
    corners.push_back({p.x, p.y});
  }
  if (area < 0) std::ranges::reverse(corners);
  for (Corner& c : corners) c = {c[0] - (box.min.x + box.max.x) / 2, c[1] - (box.min.y + box.max.y) / 2};
  return tagged(std::move(corners));
}

}  // namespace

Outcome outline_of(const Section& section, std::uint32_t segments) {
  if (segments < 2 || segments > 1024) return std::unexpected(BadSegments{segments});
  return std::visit(overloaded{
                        [&](const CircleSection& s) -> Outcome {
                          CLEAVE_CHECK(check({{"diameter", s.diameter}}));
                          return ellipse_outline(s.diameter.si() / 2, s.diameter.si() / 2, segments);
                        },
                        [&](const EllipseSection& s) -> Outcome {
                          CLEAVE_CHECK(check({{"width", s.width}, {"height", s.height}}));
                          return ellipse_outline(s.width.si() / 2, s.height.si() / 2, segments);
                        },
                        [&](const RectangleSection& s) -> Outcome {
                          CLEAVE_CHECK(check({{"width", s.width}, {"height", s.height}}));
                          const double u = s.width.si() / 2;
                          const double v = s.height.si() / 2;
                          return SectionOutline{{{-u, -v}, {u, -v}, {u, v}, {-u, v}},
                                                {tunnel_floor, tunnel_wall, tunnel_crown, tunnel_wall}};
                        },
                        [&](const DShapeSection& s) -> Outcome {
                          CLEAVE_CHECK(check({{"width", s.width}, {"wall", s.wall, true}}));
                          return arched(s.width.si(), s.wall.si(), s.width.si() / 2, segments);
                        },
                        [&](const HorseshoeSection& s) -> Outcome {
                          CLEAVE_CHECK(check({{"width", s.width}, {"height", s.height}}));
                          const double wall = s.height.si() - s.width.si() / 2;
                          if (wall < 0) return std::unexpected(HorseshoeTooLow{s.width, s.height});
                          return arched(s.width.si(), wall, s.width.si() / 2, segments);
                        },
                        [&](const TrapezoidSection& s) -> Outcome {
                          CLEAVE_CHECK(check({{"width", s.width}, {"top_width", s.top_width}, {"height", s.height}}));
                          const double u = s.width.si() / 2;
                          const double t = s.top_width.si() / 2;
                          const double v = s.height.si() / 2;
                          return SectionOutline{{{-u, -v}, {u, -v}, {t, v}, {-t, v}},
                                                {tunnel_floor, tunnel_wall, tunnel_crown, tunnel_wall}};
                        },
                        [&](const ArchSection& s) -> Outcome {
                          CLEAVE_CHECK(check({{"width", s.width}, {"wall", s.wall, true}, {"rise", s.rise}}));
                          if (s.rise.si() > s.width.si() / 2) return std::unexpected(ArchTooHigh{s.width, s.rise});
                          return arched(s.width.si(), s.wall.si(), s.rise.si(), segments);
                        },
                        [&](const PolygonSection& s) -> Outcome { return polygon_outline(s); },
                    },
                    section);
}

}  // namespace cleave::geometry
