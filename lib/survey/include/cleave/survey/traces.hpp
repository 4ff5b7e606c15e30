#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <variant>
#include <vector>

#include "cleave/survey/estimate.hpp"

/// Traces on a mapped window, and what their counts say of the whole. Coordinates in metres, in the window's plane.
namespace cleave::survey {

struct MapPoint {
  double x = 0, y = 0;
};
using Polyline = std::vector<MapPoint>;

struct CircleWindow {
  MapPoint centre;
  double radius = 0;
};
/// Simple polygon, convex or not, either sense.
struct PolygonWindow {
  std::vector<MapPoint> corners;
};
using Window = std::variant<CircleWindow, PolygonWindow>;

[[nodiscard]] double area_of(const Window& window) noexcept;
/// Whether a point lies strictly inside; one on the border does not (decided exactly for polygons, where differences of
/// coordinates are exact).
[[nodiscard]] bool holds(const Window& window, MapPoint p) noexcept;
/// Of a point from the nearest one of the border, m.
[[nodiscard]] double distance_to_border(const Window& window, MapPoint p) noexcept;
/// Width of the window across a direction (unit vector), of its convex hull.
[[nodiscard]] double width_across(const Window& window, MapPoint direction) noexcept;

/// Length of the part of a line that the window shows around a point inside it (unit direction).
[[nodiscard]] double chord_through(const Window& window, MapPoint inside, MapPoint direction);

/// A trace as the window shows it.
struct SeenTrace {
  std::size_t trace = 0;        ///< number of the polyline
  double length = 0;            ///< inside
  std::uint32_t ends = 0;       ///< inside: 0, 1, 2
  std::uint32_t crossings = 0;  ///< of the window's border
  MapPoint direction;           ///< unit, from its first to its last point (a closed one: of its longest segment)
};
/// The traces that meet the window. Polylines without length are left out. Ends within `border` (m) of the window's
/// border count as cut off by it: digitised maps often end traces there but for rounding.
[[nodiscard]] std::vector<SeenTrace> seen_through(const Window& window, std::span<const Polyline> traces,
                                                  double border = 0);

/// Counts and sums of one window or of several pooled ones.
struct WindowCounts {
  std::uint64_t n0 = 0, n1 = 0, n2 = 0;  ///< traces with 0, 1, 2 ends inside
  std::uint64_t crossings = 0;
  double length = 0;  ///< inside
  double area = 0;
  double width = 0;  ///< across the traces, mean weighted by length; of several windows the sum
  double sum_length2 = 0, sum_length_ends = 0, sum_crossings2 = 0, sum_crossings_ends = 0;  ///< over traces
  bool circle = true;                                                                       ///< all windows are circles
  double radius = 0;                                                                        ///< sum over circles
  [[nodiscard]] std::uint64_t traces() const noexcept { return n0 + n1 + n2; }
  [[nodiscard]] std::uint64_t ends() const noexcept { return n1 + 2 * n2; }
};
[[nodiscard]] WindowCounts count(const Window& window, std::span<const SeenTrace> seen);
/// Pools windows by sums.
[[nodiscard]] WindowCounts pooled(std::span<const WindowCounts> counts);

// Estimators. Trace centres are taken as a Poisson process; intervals by the delta method on the logarithm, in which
// each trace counts as one independent piece.

/// Trace midpoints per area, m/(2A): any window (Mauldon 1998).
[[nodiscard]] Estimate p20(const WindowCounts& c, double confidence = 0.95);
/// Trace length per area, S/A: any window.
[[nodiscard]] Estimate p21(const WindowCounts& c, double confidence = 0.95);
/// Trace length per area from crossings of a circle alone, x/(4R).
[[nodiscard]] Estimate p21_by_crossings(const WindowCounts& c, double confidence = 0.95);
/// Mean trace length 2S/m: any window, any law, no censoring correction.
[[nodiscard]] Estimate mean_length(const WindowCounts& c, double confidence = 0.95);
/// Mean trace length from counts: (pi R/2) x/m in circles, any orientation (Mauldon 1998, Zhang & Einstein 1998); in
/// other convex windows (A/b) x/m, b the width across the traces (Pahl 1981).
[[nodiscard]] Estimate mean_length_by_counts(const WindowCounts& c, double confidence = 0.95);
/// For comparison only: traces / area, which counts the large ones too often.
[[nodiscard]] Estimate p20_plain(const WindowCounts& c, double confidence = 0.95);

/// Points where traces cross or touch, by kind: ends alone (I), on another trace (Y), crossings (X); connections per
/// trace 4 (Y + X)/(I + Y) (Sanderson & Nixon 2015: 2 (N_Y + N_X)/N_L with N_L = (N_I + N_Y)/2).
struct Nodes {
  std::uint64_t isolated = 0, abutting = 0, crossing = 0;
  Estimate connections;
};
[[nodiscard]] Nodes nodes(const Window& window, std::span<const Polyline> traces, double tolerance,
                          double confidence = 0.95);
/// Beyond so many traces of a map nodes are not looked for.
inline constexpr std::size_t most_traces_of_nodes = 20'000;

/// An axis (radians, a and a + pi are the same) that counts with a weight.
struct WeightedAxis {
  double angle = 0, weight = 1;
};
/// Mean of axes by doubling their angles (Mardia & Jupp 2000, 13.3); each axis counts as one independent piece.
struct MeanAxis {
  double axis = 0;     ///< degrees in (-90, 90]
  Estimate direction;  ///< degrees, value in [0, 180), low <= value <= high
  Estimate alignment;  ///< length of the resultant: 1 all parallel, 0 none preferred
  Estimate kappa;      ///< Fisher's, of steep joints that leave such traces on a level outcrop: 2/-ln(alignment)
};
[[nodiscard]] MeanAxis mean_axis(std::span<const WeightedAxis> axes, double confidence = 0.95);

}  // namespace cleave::survey
