#pragma once

#include <cstddef>
#include <cstdint>
#include <numbers>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "cleave/survey/fit.hpp"

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

// ---- Size of joints -------------------------------------------------------------------------------------------------

// Joint size from trace length (Warburton 1980, Zhang & Einstein 2000).

/// E D^(k+1)/E D over E_g l^k: integral of sin^k over a quarter turn; J_1..J_4 = 1, pi/4, 2/3, 3 pi/16.
[[nodiscard]] double quarter_sine(int k);

/// Shape of the joints of a set, all similar. `aspect` = long over short side or axis; `rotation`: degrees from the
/// strike to the long one, counter-clockwise seen from above.
enum class JointShape : std::uint8_t { disc, ellipse, rectangle };
[[nodiscard]] std::string_view name_of(JointShape shape) noexcept;
struct ShapeRule {
  JointShape shape = JointShape::disc;
  double aspect = 1;
  double rotation = 0;
};

/// The chords that traces in one direction make of a shape of size 1 (diameter, long axis or long side): first and
/// second moment, its area, and for round shapes the diameter of the disc with these chords.
struct Chords {
  double first = std::numbers::pi / 4, second = 2.0 / 3;
  double area = std::numbers::pi / 4;
  std::optional<double> disc = 1;
  /// Width of the shape across the traces.
  [[nodiscard]] double width() const noexcept { return area / first; }
};
/// `trace`: angle from the strike to the traces in the joint's plane, degrees counter-clockwise seen from above.
[[nodiscard]] Chords chords_of(const ShapeRule& shape, double trace) noexcept;

/// Law of the sizes of similar joints (diameter, long axis, long side; m). Power laws have N(> x) ~ x^-exponent between
/// min and max.
struct SizeOfJoints {
  Family family = Family::exponential;
  double mean = 0, std = 0;
  double exponent = 0, min = 0, max = 0;
};
/// Distribution-free: E L^2/E L = mean/first and E L^3/E L = second/second; ratio m3/m2^2 >= 1 for every law.
struct SizeMoments {
  double m2 = 0, m3 = 0;
  [[nodiscard]] double ratio() const noexcept { return m3 / (m2 * m2); }
};
[[nodiscard]] SizeMoments size_moments(double mean_length, double second_moment, const Chords& chords = {}) noexcept;
/// By moments. Empty when no law of the family has them: the ratio is below 1, or 2 or more for gamma. The exponential
/// law takes the mean alone; a power law needs its limits, see `power_size`.
[[nodiscard]] std::optional<SizeOfJoints> size_law(Family family, double mean_length, double second_moment,
                                                   const Chords& chords = {});
/// Power law between given limits with E L^2/E L = m2; empty when that lies outside the limits.
[[nodiscard]] std::optional<SizeOfJoints> power_size(double m2, double min, double max);
/// Mean and standard deviation of the sizes that a fitted law of trace lengths implies by moments, with intervals from
/// the fit's own; values empty where no law of sizes has such traces.
[[nodiscard]] Estimate size_mean_by_moments(const Fit& lengths, const Chords& chords = {}, double confidence = 0.95);
[[nodiscard]] Estimate size_std_by_moments(const Fit& lengths, const Chords& chords = {}, double confidence = 0.95);
/// E L^k of the law.
[[nodiscard]] double size_moment(const SizeOfJoints& law, int k);
/// E l^3 of the traces that a law of discs implies, (3 pi/16) E D^4/E D: for choosing among laws.
[[nodiscard]] double third_moment(const SizeOfJoints& law);

/// Law of the diameters of discs by maximum likelihood from the traces as they were seen: trace lengths have the
/// density (l/E D) int f(D)/sqrt(D^2 - l^2) dD (Warburton 1980), with both kinds of censoring and truncation as in
/// `fit_lengths`. Empty when there is no complete or half complete length. Power laws take the smallest length and ten
/// times the largest as limits.
[[nodiscard]] std::optional<Fit> fit_discs(std::span<const SeenLength> lengths, const Meeting& meeting, Family family);
[[nodiscard]] SizeOfJoints size_of(const Fit& sizes);

/// Density of trace lengths of discs with this law of diameters, and the probability of more than l.
[[nodiscard]] double disc_trace_density(const Fit& diameters, double l);
[[nodiscard]] double disc_trace_above(const Fit& diameters, double l);
/// `Meeting::chance` of the traces of these discs.
[[nodiscard]] double disc_chance(const Fit& diameters, const Meeting& meeting);

/// Ellipse with axes a >= a/k seen along a trace at `beta` (radians) from the long axis in its plane: chords are those
/// of a disc of diameter M a (Zhang, Einstein & Dershowitz 2002).
[[nodiscard]] double ellipse_factor(double aspect, double beta);

/// Chords of a parallelogram (Warburton 1980b): longest chord, share of chords that have it, mean.
struct ParallelogramChords {
  double longest = 0, share_longest = 0, mean = 0;
};
[[nodiscard]] ParallelogramChords parallelogram_chords(double p, double q, double angle_p, double angle_q);

}  // namespace cleave::survey
