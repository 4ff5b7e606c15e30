#include "cleave/geometry/tunnel.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "cleave/core/expected.hpp"
#include "cleave/core/overloaded.hpp"
#include "cleave/geometry/predicates.hpp"
#include "tunnel_tags.hpp"

namespace cleave::geometry {
namespace {

using Ring = std::vector<Vec3>;

/// The axis without the points that add nothing, and which of the given points are left.
struct Axis {
  std::vector<Vec3> points;
  std::vector<std::size_t> given;
  std::vector<Vec3> along;  ///< unit, of each segment
};

std::expected<Axis, TunnelError> axis_of(const std::vector<Vec3>& points) {
  if (points.size() < 2) return std::unexpected(AxisTooShort{points.size()});
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!in_range(points[i])) return std::unexpected(BadAxisPoint{i});
  }
  Axis axis;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (i > 0) {
      const Vec3 step = points[i] - points[i - 1];
      if (!(norm(step) > 0)) return std::unexpected(ZeroLengthAxis{i - 1});
      const Vec3 along = normalized(step);
      const bool goes_on =
          !axis.along.empty() && norm(cross(along, axis.along.back())) < 1e-12 && dot(along, axis.along.back()) > 0;
      if (goes_on) {
        axis.points.back() = points[i];
        axis.given.back() = i;
        axis.along.back() = normalized(points[i] - axis.points[axis.points.size() - 2]);
        continue;
      }
      axis.along.push_back(along);
    }
    axis.points.push_back(points[i]);
    axis.given.push_back(i);
  }
  return axis;
}

/// Power of two (m) that all corners are multiples of: 1 nm unless the coordinates leave no room for it in a double.
double quantum_for(const std::vector<Vec3>& axis) {
  double largest = 1;
  for (const Vec3& p : axis) largest = std::max({largest, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
  return std::max(opening_quantum.si(), std::ldexp(1.0, std::ilogb(largest) + 2 - 52));
}

Vec3 rounded(Vec3 p, double quantum) {
  return {std::nearbyint(p.x / quantum) * quantum, std::nearbyint(p.y / quantum) * quantum,
          std::nearbyint(p.z / quantum) * quantum};
}

/// The ring of corners at each point of the axis, not yet rounded.
std::expected<std::vector<Ring>, TunnelError> sweep(const Axis& axis, const SectionOutline& outline, Vec3 right,
                                                    Vec3 up) {
  std::vector<Ring> rings(1);
  for (const auto& [u, v] : outline.corners) rings[0].push_back(axis.points[0] + u * right + v * up);
  for (std::size_t s = 0; s < axis.along.size(); ++s) {
    const Vec3 along = axis.along[s];
    const bool last = s + 1 == axis.along.size();
    const Vec3 mitre = last ? along : along + axis.along[s + 1];
    const double lean = dot(along, mitre);
    if (!(lean > 1e-6)) return std::unexpected(BendTooSharp{axis.given[s + 1]});
    Ring next;
    for (const Vec3& p : rings.back()) {
      const double way = dot(axis.points[s + 1] - p, mitre) / lean;
      if (!(way > 1e-9)) return std::unexpected(BendTooSharp{axis.given[s + 1]});
      next.push_back(p + way * along);
    }
    rings.push_back(std::move(next));
  }
  return rings;
}

/// Corners of all rings one after the other.
std::vector<Vec3> vertices_of(const std::vector<Ring>& rings, const Axis& axis) {
  const double quantum = quantum_for(axis.points);
  std::vector<Vec3> vertices;
  for (const Ring& ring : rings) {
    for (const Vec3& p : ring) vertices.push_back(rounded(p, quantum));
  }
  if (axis.along.size() == 1) {
    const Vec3 whole = rounded(axis.points[1] - axis.points[0], quantum);
    const std::size_t n = rings[0].size();
    for (std::size_t i = 0; i < n; ++i)
      vertices[n + i] = vertices[i] + whole;  // exact: both are multiples of the quantum
  }
  return vertices;
}

std::vector<SolidFace> faces_of(const SectionOutline& outline, std::size_t rings) {
  const auto n = static_cast<std::uint32_t>(outline.corners.size());
  const auto segments = static_cast<std::uint32_t>(rings - 1);
  std::vector<SolidFace> faces;
  for (std::uint32_t s = 0; s < segments; ++s) {
    for (std::uint32_t i = 0; i < n; ++i) {
      const std::uint32_t j = (i + 1) % n;
      faces.push_back({{s * n + j, s * n + i, (s + 1) * n + i, (s + 1) * n + j}, outline.tags[i]});
    }
  }
  // The outline is counter-clockwise to somebody who looks along the axis, so it looks out of the start as it is.
  std::vector<std::uint32_t> cap(n);
  std::iota(cap.begin(), cap.end(), 0U);
  faces.push_back({cap, tunnel_start});
  std::ranges::reverse(cap);
  for (std::uint32_t& v : cap) v += segments * n;
  faces.push_back({std::move(cap), tunnel_end});
  return faces;
}

}  // namespace

std::expected<Solid, TunnelError> make_tunnel(const Section& section, const std::vector<Vec3>& axis,
                                              const TunnelOptions& options) {
  CLEAVE_TRY(const SectionOutline outline, outline_of(section, options.segments));
  CLEAVE_TRY(const Axis path, axis_of(axis));
  const Vec3 wanted = options.up.value_or(Vec3{0, 0, 1});
  const double length = norm(wanted);
  if (!std::isfinite(length) || !(length > 0)) return std::unexpected(UpAlongAxis{0});
  const Vec3 along = path.along.front();
  const Vec3 across = cross(along, wanted / length);
  if (!(norm(across) > 1e-6)) return std::unexpected(UpAlongAxis{0});
  const Vec3 right = normalized(across);
  const Vec3 up = cross(right, along);
  CLEAVE_TRY(const std::vector<Ring> rings, sweep(path, outline, right, up));
  auto solid = Solid::make(vertices_of(rings, path), faces_of(outline, rings.size()),
                           {"wall", "floor", "crown", "start", "end"});
  if (!solid) return std::unexpected(TunnelNotSolid{solid.error()});
  return *std::move(solid);
}

std::string describe(const TunnelError& error) {
  return std::visit(
      overloaded{
          [](const NonPositiveDimension& e) {
            return fmt::format("{} of the section is {} m; it must be positive", e.what, e.value.si());
          },
          [](HorseshoeTooLow e) {
            return fmt::format(
                "a horseshoe {} m wide is at least {} m high (half circle), this one is {} m; make it higher or "
                "narrower, or use "
                "shape = \"arch\"",
                e.width.si(), e.width.si() / 2, e.height.si());
          },
          [](ArchTooHigh e) {
            return fmt::format(
                "an arch {} m wide rises at most {} m (half circle), this one {} m; lower the rise or raise the wall",
                e.width.si(), e.width.si() / 2, e.rise.si());
          },
          [](BadSegments e) { return fmt::format("{} segments for a half circle; give 2 to 1024", e.segments); },
          [](const BadSection& e) { return fmt::format("the section's outline: {}", describe(e.reason)); },
          [](AxisTooShort e) { return fmt::format("the axis has {} points; give at least two", e.points); },
          [](BadAxisPoint e) {
            return fmt::format(
                "point {} of the axis is not a usable position (not a number, infinite, or beyond 1e12 m); correct its "
                "coordinates",
                e.point);
          },
          [](ZeroLengthAxis e) {
            return fmt::format("points {} and {} of the axis are the same; remove one or correct it", e.segment,
                               e.segment + 1);
          },
          [](UpAlongAxis) {
            return std::string{
                "the axis starts along the up direction, so the section cannot be placed; give up = [x, y, z] at an "
                "angle to the axis"};
          },
          [](BendTooSharp e) {
            return fmt::format(
                "the section does not fit round the bend at point {} of the axis; make the bend wider, the segments "
                "longer, or "
                "the section smaller",
                e.point);
          },
          [](const TunnelNotSolid& e) {
            return std::holds_alternative<FacesCross>(e.reason)
                       ? std::string{"the tunnel runs into itself; give the parts that meet as tunnels of their own, "
                                     "which may cross"}
                       : describe(e.reason);
          },
      },
      error);
}

}  // namespace cleave::geometry
