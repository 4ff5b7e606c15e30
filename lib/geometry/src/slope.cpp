#include "cleave/geometry/terrain.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "cleave/core/overloaded.hpp"

namespace cleave::geometry {
namespace {

using Point = std::array<double, 2>;

/// The domain in the directions along and across a profile, grown so that the cut clears it.
struct Window {
  Vec3 along, strike;
  double s_lo, s_hi, t_lo, t_hi, z_lo, z_hi;
};

Window window_of(const Reach& reach, DipDirection direction, Vec3 origin) {
  Window w{};
  const double degrees = direction.degrees();
  w.along = {sin_degrees(degrees), cos_degrees(degrees), 0};
  w.strike = cross(Vec3{0, 0, 1}, w.along);
  bool first = true;
  for (const double x : {reach.min.x, reach.max.x}) {
    for (const double y : {reach.min.y, reach.max.y}) {
      const Vec3 p{x - origin.x, y - origin.y, 0};
      const double s = dot(p, w.along), t = dot(p, w.strike);
      w.s_lo = first ? s : std::min(w.s_lo, s);
      w.s_hi = first ? s : std::max(w.s_hi, s);
      w.t_lo = first ? t : std::min(w.t_lo, t);
      w.t_hi = first ? t : std::max(w.t_hi, t);
      first = false;
    }
  }
  const double margin = 0.01 * norm(reach.max - reach.min);
  w.s_lo -= margin;
  w.s_hi += margin;
  w.t_lo -= margin;
  w.t_hi += margin;
  w.z_lo = reach.min.z - margin;
  w.z_hi = reach.max.z + margin;
  return w;
}

/// The outline (s, z) swept along the strike.
std::expected<Solid, SlopeError> sweep(std::vector<Point> outline, const Window& w, Vec3 origin) {
  Point lo = outline[0], hi = outline[0];
  for (const Point& p : outline) {
    for (std::size_t k = 0; k < 2; ++k) {
      lo[k] = std::min(lo[k], p[k]);
      hi[k] = std::max(hi[k], p[k]);
    }
  }
  const Vec3 centre = Vec3{origin.x, origin.y, 0} + 0.5 * (lo[0] + hi[0]) * w.along + Vec3{0, 0, 0.5 * (lo[1] + hi[1])};
  auto solid = make_tunnel(PolygonSection{std::move(outline)}, {centre + w.t_lo * w.strike, centre + w.t_hi * w.strike},
                           {.segments = 16, .up = Vec3{0, 0, 1}});
  if (!solid) return std::unexpected(std::move(solid).error());
  return std::move(*solid);
}

/// The polygon at distance d inside all sides of a counter-clockwise one, corner by corner (mitred).
std::vector<Point> inset(const std::vector<Point>& plan, double d) {
  std::vector<Point> out;
  const std::size_t count = plan.size();
  const auto normal = [&](std::size_t i) {  // inwards
    const Point &a = plan[i], &b = plan[(i + 1) % count];
    const double x = b[0] - a[0], y = b[1] - a[1], length = std::hypot(x, y);
    return Point{-y / length, x / length};
  };
  for (std::size_t i = 0; i < count; ++i) {
    const Point m = normal((i + count - 1) % count), n = normal(i);
    const double scale = d / (1 + m[0] * n[0] + m[1] * n[1]);
    out.push_back({plan[i][0] + scale * (m[0] + n[0]), plan[i][1] + scale * (m[1] + n[1])});
  }
  return out;
}

/// Whether the inset polygon is still one: no side turned round, and simple.
bool sound(const std::vector<Point>& plan, const std::vector<Point>& inner) {
  const std::size_t count = plan.size();
  std::vector<Vec3> corners;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t j = (i + 1) % count;
    const double along = (plan[j][0] - plan[i][0]) * (inner[j][0] - inner[i][0]) +
                         (plan[j][1] - plan[i][1]) * (inner[j][1] - inner[i][1]);
    if (!(along > 0)) return false;
    corners.push_back({inner[i][0], inner[i][1], 0});
  }
  return Polygon::make(std::move(corners)).has_value();
}

std::expected<Solid, SlopeError> frustum(const std::vector<Point>& upper, double top, const std::vector<Point>& lower,
                                         double bottom, bool convex) {
  const auto count = static_cast<std::uint32_t>(upper.size());
  std::vector<Vec3> vertices;
  for (const Point& p : lower) vertices.push_back({p[0], p[1], bottom});
  for (const Point& p : upper) vertices.push_back({p[0], p[1], top});
  std::vector<SolidFace> faces;
  SolidFace floor{{}, 1}, roof{{}, 2};
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::uint32_t j = (i + 1) % count;
    faces.push_back({{i, j, count + j, count + i}, 0});
    floor.corners.push_back(count - 1 - i);
    roof.corners.push_back(count + i);
  }
  faces.push_back(std::move(floor));
  faces.push_back(std::move(roof));
  auto solid = Solid::make(std::move(vertices), std::move(faces), {"face", "floor", "top"});
  if (!solid) return std::unexpected(std::move(solid).error());
  return convex ? std::move(*solid).with_half_spaces() : std::move(*solid);
}

}  // namespace

std::expected<Solid, SlopeError> make_plane_cut(const PlaneCut& cut, const Reach& reach) {
  const Window w = window_of(reach, cut.plane.direction, cut.through);
  // Above the plane: n . (s, z - z0) > 0. The rectangle of the window clipped by that.
  const Point n{sin_degrees(cut.plane.dip.degrees()), cos_degrees(cut.plane.dip.degrees())};
  const auto height = [&](const Point& p) { return n[0] * p[0] + n[1] * (p[1] - cut.through.z); };
  const std::array<Point, 4> corners{{{w.s_lo, w.z_lo}, {w.s_hi, w.z_lo}, {w.s_hi, w.z_hi}, {w.s_lo, w.z_hi}}};
  std::vector<Point> outline;
  for (std::size_t i = 0; i < 4; ++i) {
    const Point &a = corners.at(i), &b = corners.at((i + 1) % 4);
    const double ha = height(a), hb = height(b);
    if (ha >= 0) outline.push_back(a);
    if ((ha > 0 && hb < 0) || (ha < 0 && hb > 0)) {
      const double f = ha / (ha - hb);
      outline.push_back({a[0] + f * (b[0] - a[0]), a[1] + f * (b[1] - a[1])});
    }
  }
  if (outline.size() < 3) return std::unexpected(NothingCut{});
  return sweep(std::move(outline), w, cut.through);
}

std::expected<Solid, SlopeError> make_profile_cut(const ProfileCut& cut, const Reach& reach) {
  for (std::size_t i = 0; i < cut.points.size(); ++i) {
    const bool finite = std::isfinite(cut.points[i][0]) && std::isfinite(cut.points[i][1]);
    if (!finite || (i > 0 && !(cut.points[i][0] > cut.points[i - 1][0]))) return std::unexpected(BadProfile{i});
  }
  if (cut.points.size() < 2) return std::unexpected(BadProfile{cut.points.size()});
  const Vec3 origin{cut.origin[0], cut.origin[1], 0};
  const Window w = window_of(reach, cut.direction, origin);
  std::vector<Point> outline = cut.points;
  double roof = w.z_hi;
  for (const Point& p : cut.points) roof = std::max(roof, p[1] + 0.01 * norm(reach.max - reach.min));
  if (w.s_lo < outline.front()[0]) outline.insert(outline.begin(), {w.s_lo, outline.front()[1]});
  if (w.s_hi > outline.back()[0]) outline.push_back({w.s_hi, outline.back()[1]});
  outline.push_back({outline.back()[0], roof});
  outline.push_back({outline.front()[0], roof});
  return sweep(std::move(outline), w, origin);
}

std::expected<std::vector<Solid>, SlopeError> make_benches(const BenchCut& cut, double clear_to) {
  if (cut.count < 1 || cut.count > 1000) return std::unexpected(BadBench{"count"});
  if (!(cut.height.si() > 0)) return std::unexpected(BadBench{"height"});
  if (!(cut.width.si() >= 0)) return std::unexpected(BadBench{"width"});
  if (!(cut.angle > 0 && cut.angle <= 90)) return std::unexpected(BadBench{"angle"});
  std::vector<Vec3> corners;
  for (const Point& p : cut.plan) corners.push_back({p[0], p[1], 0});
  const auto polygon = Polygon::make(std::move(corners));
  if (!polygon) return std::unexpected(BadPlan{polygon.error()});
  // Counter-clockwise, without corners in the middle of a straight side (they have no sides of their own to move).
  std::vector<Point> plan;
  const auto given = polygon->corners();
  double area = 0;
  for (std::size_t i = 0; i < given.size(); ++i) {
    const Vec3 a = given[i], b = given[(i + 1) % given.size()], c = given[(i + 2) % given.size()];
    area += a.x * b.y - a.y * b.x;
    if (cross(b - a, c - b).z != 0) plan.push_back({b.x, b.y});
  }
  if (area < 0) std::ranges::reverse(plan);

  const double run = cut.angle == 90 ? 0 : cut.height.si() * cos_degrees(cut.angle) / sin_degrees(cut.angle);
  std::vector<Solid> solids;
  if (clear_to > cut.top) {
    auto room = frustum(plan, clear_to, plan, cut.top, polygon->convex());
    if (!room) return std::unexpected(std::move(room).error());
    solids.push_back(std::move(*room));
  }
  for (std::uint32_t k = 0; k < cut.count; ++k) {
    const std::vector<Point> upper = inset(plan, k * (run + cut.width.si())),
                             lower = inset(plan, k * (run + cut.width.si()) + run);
    if (!sound(plan, upper) || !sound(plan, lower)) return std::unexpected(BenchCloses{k + 1});
    auto bench =
        frustum(upper, cut.top - k * cut.height.si(), lower, cut.top - (k + 1) * cut.height.si(), polygon->convex());
    if (!bench) return std::unexpected(std::move(bench).error());
    solids.push_back(std::move(*bench));
  }
  return solids;
}

std::string describe(const SlopeError& error) {
  return std::visit(
      overloaded{
          [](const NothingCut&) {
            return std::string{"lies above the whole domain and takes nothing out; check its point and dip"};
          },
          [](const BadProfile& e) {
            return fmt::format(
                "point {} is missing, not a number, or not further along than the one before; list two points or more "
                "(s, z) with growing s",
                e.point);
          },
          [](const BadBench& e) {
            return fmt::format(
                "{} is out of range; count is 1 to 1000, height above 0, width 0 or more, angle above 0 to 90 degrees",
                e.what);
          },
          [](const BadPlan& e) { return describe(e.reason); },
          [](const BenchCloses& e) {
            return fmt::format(
                "the pit closes at bench {}; give fewer benches, steeper faces, narrower berms or a larger plan",
                e.bench);
          },
          [](const TunnelError& e) { return describe(e); },
          [](const SolidError& e) { return describe(e); },
      },
      error);
}

}  // namespace cleave::geometry
