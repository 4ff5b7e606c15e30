#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <expected>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "cleave/core/quantity.hpp"
#include "cleave/geometry/polygon.hpp"
#include "cleave/geometry/solid.hpp"
#include "cleave/geometry/vec3.hpp"

/// Tunnels, shafts and caverns: a section swept along a polyline.
namespace cleave::geometry {

// ---- sections: looking along the axis, u to the right, v up
// ------------------------------------------------------------

/// Polygon of the same area as the circle; it reaches 0.16 % of the radius beyond it with the default 32 segments.
struct CircleSection {
  Length diameter;
};
/// Polygon of the same area as the ellipse.
struct EllipseSection {
  Length width, height;
};
struct RectangleSection {
  Length width, height;
};
/// Straight walls under a half circle of the section's width, given by the height of the walls; wall = 0 is a half
/// disc.
struct DShapeSection {
  Length width, wall;
};
/// Walls of height - width / 2 under a half circle, given by the whole height.
struct HorseshoeSection {
  Length width, height;
};
/// Flat floor and roof, centred on each other.
struct TrapezoidSection {
  Length width, top_width, height;  ///< width of the floor
};
/// Straight walls under a circular arc that rises `rise` above them; rise <= width / 2; the whole height is wall +
/// rise.
struct ArchSection {
  Length width, wall, rise;
};
/// Any simple outline, (u, v) in metres in either sense; the axis runs through the centre of its bounding box, wherever
/// (0, 0) is.
struct PolygonSection {
  std::vector<std::array<double, 2>> corners;
};
using Section = std::variant<CircleSection, EllipseSection, RectangleSection, DShapeSection, HorseshoeSection,
                             TrapezoidSection, ArchSection, PolygonSection>;

struct TunnelOptions {
  /// Segments of a half circle (a whole circle has twice as many, an arc its share, at least two). Corners of arcs in
  /// D, horseshoe and arch sections lie on the arc, so these sections are slightly smaller than the curved ones.
  std::uint32_t segments = 16;
  /// Which way v points along the whole axis; needed where the axis starts vertical. It need not be at right angles to
  /// the axis. Segments along it keep the section of the one before.
  std::optional<Vec3> up;
};

// ---- errors
// -------------------------------------------------------------------------------------------------------------

struct NonPositiveDimension {
  std::string what;  ///< "width", "height", ...
  Length value;
};
struct HorseshoeTooLow {  ///< height < width / 2
  Length width, height;
};
struct ArchTooHigh {  ///< rise > width / 2
  Length width, rise;
};
struct BadSegments {
  std::uint32_t segments;  ///< of a half circle; 2 to 1024
};
struct BadSection {  ///< the outline of a polygon section
  PolygonError reason;
};
struct AxisTooShort {
  std::size_t points;  ///< fewer than two
};
struct BadAxisPoint {
  std::size_t point;  ///< not a number, infinite, or beyond 1e12 m
};
struct ZeroLengthAxis {
  std::size_t segment;  ///< joins points i and i + 1
};
struct UpAlongAxis {  ///< the up direction (z where none is given) runs along the axis, or is not a direction
  std::size_t segment;
};
struct SectionTurns {  ///< between segments that both keep v upwards the section would turn about the axis by more than
                       ///< 45 degrees
  std::size_t point;
  double degrees;
};
struct BendTooSharp {  ///< the section does not fit round the bend, or the axis turns back
  std::size_t point;
};
struct TunnelNotSolid {  ///< most often: the tunnel runs into itself
  SolidError reason;
};
using TunnelError =
    std::variant<NonPositiveDimension, HorseshoeTooLow, ArchTooHigh, BadSegments, BadSection, AxisTooShort,
                 BadAxisPoint, ZeroLengthAxis, UpAlongAxis, SectionTurns, BendTooSharp, TunnelNotSolid>;
/// "what is wrong; what to do", in words for an engineer. Points are numbered from 0.
[[nodiscard]] std::string describe(const TunnelError& error);

// ---- the solid
// ----------------------------------------------------------------------------------------------------------

/// What corners of tunnels and of slopes by plane or profile are rounded to (coarser beyond 4,000 km).
inline constexpr Length opening_quantum = metres(0x1p-30);

/// Unit directions of a segment of an axis and of the section's u and v there, at right angles to each other.
struct SectionFrame {
  Vec3 along, right, up;
};
/// One frame a segment of a polyline (m) without repeated points: v as near to `up` as a right angle to the segment
/// allows, so that floors stay level however a decline winds; a segment along `up` takes over the v of the one before.
[[nodiscard]] std::vector<SectionFrame> section_frames(const std::vector<Vec3>& axis, Vec3 up);

/// The space a tunnel takes, with tags wall, floor, crown, start, end (in this order, all present).
///
/// `axis`: at least two points (m), the polyline through the centres of the section's bounding box; caps at right
/// angles to its first and last segment, mitre planes at the bends. v points up on every segment (`section_frames`);
/// the section keeps its true shape across every segment. Where bends of an inclined axis turn it about the axis from
/// one segment to the next, the ring at the bend is the mean of both and the sides beside it are triangles, within half
/// the section's reach or a quarter of the segment. Points on a straight line add nothing. u = axis x v points to the
/// right. Corners are rounded to `opening_quantum`, and the far corner of each side of a straight axis is the near
/// corner plus exactly the same vector, so that sides stay exactly planar parallelograms on the cutter's lattice.
[[nodiscard]] std::expected<Solid, TunnelError> make_tunnel(const Section& section, const std::vector<Vec3>& axis,
                                                            const TunnelOptions& options = {});

/// The section's outline: (u, v) in m, counter-clockwise with u to the right and v up, centred on its bounding box,
/// with the tag index of the side after each corner (0 wall, 1 floor, 2 crown).
struct SectionOutline {
  std::vector<std::array<double, 2>> corners;
  std::vector<std::uint32_t> tags;
};
[[nodiscard]] std::expected<SectionOutline, TunnelError> outline_of(const Section& section,
                                                                    std::uint32_t segments = 16);

}  // namespace cleave::geometry
