#include "cleave/geometry/tunnel.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
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

/// Turn of the section about the axis from one segment to the next, radians: what is left when the bend alone is
/// taken away.
double turn_between(const SectionFrame& a, const SectionFrame& b) {
  // The reflection in the mitre plane takes a's direction to b's turned round, and right to what the bend makes of it.
  const Vec3 mitre = normalized(a.along + b.along);
  const Vec3 carried = a.right - 2 * dot(a.right, mitre) * mitre;
  return std::atan2(dot(carried, b.up), dot(carried, b.right));
}

/// Turns below this are roundings: the sides stay plane.
constexpr double no_turn = 1e-7;

/// Turn at each point of the axis; 0 at its ends.
std::expected<std::vector<double>, TunnelError> turns_of(const Axis& axis, const std::vector<SectionFrame>& frames) {
  std::vector<double> turns(axis.points.size());
  for (std::size_t s = 0; s + 1 < frames.size(); ++s) {
    if (!(dot(axis.along[s], axis.along[s] + axis.along[s + 1]) > 1e-6)) {
      return std::unexpected(BendTooSharp{axis.given[s + 1]});
    }
    turns[s + 1] = turn_between(frames[s], frames[s + 1]);
    const double degrees = std::abs(turns[s + 1]) * (180 / std::numbers::pi);
    if (!(degrees <= 45)) return std::unexpected(SectionTurns{axis.given[s + 1], degrees});
  }
  return turns;
}

/// How the ends of a piece of a tunnel are turned against each other.
enum class Twist : std::uint8_t { none, left, right };

/// Rings of corners along the axis, not yet rounded, and the twist of the piece behind each but the first.
struct Sweep {
  std::vector<Ring> rings;
  std::vector<Twist> twists;
};

/// Each ring is the one before moved along to the next mitre plane.
std::expected<Sweep, TunnelError> sweep(const Axis& axis, const SectionOutline& outline, const SectionFrame& first) {
  Sweep out;
  out.rings.emplace_back();
  for (const auto& [u, v] : outline.corners) {
    out.rings[0].push_back(axis.points[0] + u * first.right + v * first.up);
  }
  for (std::size_t s = 0; s < axis.along.size(); ++s) {
    const Vec3 along = axis.along[s];
    const bool last = s + 1 == axis.along.size();
    const Vec3 mitre = last ? along : along + axis.along[s + 1];
    const double lean = dot(along, mitre);
    if (!(lean > 1e-6)) return std::unexpected(BendTooSharp{axis.given[s + 1]});
    Ring next;
    for (const Vec3& p : out.rings.back()) {
      const double way = dot(axis.points[s + 1] - p, mitre) / lean;
      if (!(way > 1e-9)) return std::unexpected(BendTooSharp{axis.given[s + 1]});
      next.push_back(p + way * along);
    }
    out.rings.push_back(std::move(next));
    out.twists.push_back(Twist::none);
  }
  return out;
}

/// The section of segment s on the mitre plane at one of its ends.
Ring ring_at(const Axis& axis, const SectionOutline& outline, const SectionFrame& frame, std::size_t s,
             std::size_t point) {
  const bool end = point == 0 || point == axis.along.size();
  const Vec3 along = axis.along[s], mitre = end ? along : axis.along[point - 1] + axis.along[point];
  Ring ring;
  for (const auto& [u, v] : outline.corners) {
    const Vec3 off = u * frame.right + v * frame.up;
    ring.push_back(axis.points[point] + off - (dot(off, mitre) / dot(along, mitre)) * along);
  }
  return ring;
}

/// Where the section turns about the axis the ring at the bend is the mean of both segments', and the turn is taken
/// up beside it: within half the section's reach, or a quarter of the segment where that is shorter.
std::expected<Sweep, TunnelError> turned_sweep(const Axis& axis, const SectionOutline& outline,
                                               const std::vector<SectionFrame>& frames,
                                               const std::vector<double>& turns) {
  double reach = 0;
  for (const auto& [u, v] : outline.corners) reach = std::max(reach, std::hypot(u, v));
  Sweep out;
  out.rings.push_back(ring_at(axis, outline, frames[0], 0, 0));
  const auto piece = [&](Ring ring, Twist twist) {
    out.rings.push_back(std::move(ring));
    out.twists.push_back(twist);
  };
  const auto twist_at = [&](std::size_t point) {
    if (!(std::abs(turns[point]) > no_turn)) return Twist::none;
    return turns[point] < 0 ? Twist::left : Twist::right;
  };
  for (std::size_t s = 0; s < axis.along.size(); ++s) {
    Ring from = ring_at(axis, outline, frames[s], s, s), to = ring_at(axis, outline, frames[s], s, s + 1);
    double shortest = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < from.size(); ++i) {
      shortest = std::min(shortest, dot(to[i] - from[i], axis.along[s]));
    }
    if (!(shortest > 1e-9)) return std::unexpected(BendTooSharp{axis.given[s + 1]});
    const Vec3 room = std::min(reach / 2, shortest / 4) * axis.along[s];
    if (twist_at(s) != Twist::none) {
      for (Vec3& p : from) p += room;
      piece(std::move(from), twist_at(s));
    }
    if (twist_at(s + 1) == Twist::none) {
      piece(std::move(to), Twist::none);
      continue;
    }
    Ring mean = ring_at(axis, outline, frames[s + 1], s + 1, s + 1);
    for (std::size_t i = 0; i < mean.size(); ++i) {
      mean[i] = 0.5 * (mean[i] + to[i]);
      to[i] = to[i] - room;
    }
    piece(std::move(to), Twist::none);
    piece(std::move(mean), twist_at(s + 1));
  }
  return out;
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

std::vector<SolidFace> faces_of(const SectionOutline& outline, const std::vector<Twist>& twists) {
  const auto n = static_cast<std::uint32_t>(outline.corners.size());
  const auto segments = static_cast<std::uint32_t>(twists.size());
  std::vector<SolidFace> faces;
  for (std::uint32_t s = 0; s < segments; ++s) {
    for (std::uint32_t i = 0; i < n; ++i) {
      const std::uint32_t j = (i + 1) % n;
      const std::uint32_t a = s * n + j, b = s * n + i, c = (s + 1) * n + i, d = (s + 1) * n + j;
      if (twists[s] != Twist::none) {
        // Behind the bend along the other diagonal: what one side adds the other takes away. The image of a tunnel in a
        // mirror is twisted the other way, and has the images of its triangles.
        const bool behind = s > 0 && twists[s - 1] != Twist::none, other = behind != (twists[s] == Twist::left);
        faces.push_back({{a, b, other ? d : c}, outline.tags[i]});
        faces.push_back({{other ? b : a, c, d}, outline.tags[i]});
        continue;
      }
      faces.push_back({{a, b, c, d}, outline.tags[i]});
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

std::vector<SectionFrame> section_frames(const std::vector<Vec3>& axis, Vec3 up) {
  std::vector<SectionFrame> frames;
  const Vec3 upwards = normalized(up);
  for (std::size_t s = 0; s + 1 < axis.size(); ++s) {
    const Vec3 along = normalized(axis[s + 1] - axis[s]);
    Vec3 across = cross(along, upwards);
    if (!(norm(across) > 1e-6)) {
      across = Vec3{1, 0, 0};
      if (!frames.empty()) {
        const Vec3 mitre = along + frames.back().along;
        const double square = dot(mitre, mitre);
        across = frames.back().right;
        if (square > 0) across = across - (2 * dot(across, mitre) / square) * mitre;
      }
    }
    const Vec3 right = normalized(across);
    frames.push_back({along, right, cross(right, along)});
  }
  return frames;
}

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
  const std::vector<SectionFrame> frames = section_frames(path.points, wanted / length);
  CLEAVE_TRY(const std::vector<double> turns, turns_of(path, frames));
  const bool turned = std::ranges::any_of(turns, [](double turn) { return std::abs(turn) > no_turn; });
  CLEAVE_TRY(const Sweep way, turned ? turned_sweep(path, outline, frames, turns) : sweep(path, outline, frames[0]));
  auto solid = Solid::make(vertices_of(way.rings, path), faces_of(outline, way.twists),
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
          [](SectionTurns e) {
            return fmt::format(
                "with its floor kept level the section would turn about the axis by {:.0f} degrees at point {}; bend "
                "the "
                "axis in more, smaller steps there, or give the parts that meet as tunnels of their own, which may "
                "cross",
                e.degrees, e.point);
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
