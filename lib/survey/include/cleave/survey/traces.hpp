#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <numbers>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "cleave/core/quantity.hpp"
#include "cleave/core/vec2.hpp"

/// Traces on a mapped window, and what their counts say of the whole. Coordinates in metres, in the window's plane.
namespace cleave::survey {

/// A figure of a survey with its confidence interval. `note` says how it came about or why it cannot be had.
struct Estimate {
  std::string name;
  std::optional<double> value;  ///< empty: not estimable
  double low = 0, high = 0;
  std::string method;
  std::string note;
};

/// Whether anything is known of the error: no interval reaches from 0 to infinity.
[[nodiscard]] inline bool bounded(const Estimate& e) noexcept { return e.low != 0 || std::isfinite(e.high); }

/// a/b of two positive estimates that scatter independently: their half widths on the logarithm are added as squares.
[[nodiscard]] Estimate over(const Estimate& a, const Estimate& b, std::string name, std::string method);

// Laws fitted to lengths and spacings by maximum likelihood, with censoring.

enum class Family : std::uint8_t { exponential, lognormal, gamma, power, normal, constant };
[[nodiscard]] std::string_view name_of(Family family) noexcept;

/// A fitted law. Parameters: exponential mean; lognormal mu, sigma of the logarithm; gamma shape, scale; power exponent
/// with the limits min, max; normal mu > 0 and sigma of the law before it is cut at 0; constant (all of one size) the
/// size.
struct Fit {
  Family family = Family::exponential;
  double a = 1, b = 1;
  double min = 0, max = 0;  ///< power; constant: max is the largest standard deviation that the traces allow
  double log_likelihood = 0;
  double aic = 0;
  std::optional<double> p_value;  ///< Kolmogorov-Smirnov, parametric bootstrap (complete data only)
  double distance = 0;            ///< Kolmogorov-Smirnov
  /// Parameters (a, b) moved by one standard error along independent directions (inverse of the observed information);
  /// empty: the likelihood has no curvature to tell them from.
  std::vector<std::array<double, 2>> moved;

  [[nodiscard]] double density(double x) const;
  [[nodiscard]] double below(double x) const;  ///< distribution function
  [[nodiscard]] double quantile(double u) const;
  [[nodiscard]] double moment(int k) const;  ///< E x^k
  /// Integral of the survival function from x on: E (X - x)+.
  [[nodiscard]] double mean_excess(double x) const;
};

/// A length as it was seen: `ends` of 2 complete, 1 one end, 0 no end in sight.
struct SeenLength {
  double length = 0;
  std::uint32_t ends = 2;
};

/// How lengths were met. A window of area A whose width across the traces is b meets a trace of length l with
/// probability proportional to A + b l; a line has A = 0, b = 1 (Laslett 1982). Pieces that look shorter than
/// `truncation` were not mapped (they are left out where they were): of a window, A - b l0 times the survival function
/// plus b times the mean excess at l0 are left, up to terms in (l0/window)^2; of a line, whole traces above l0.
struct Meeting {
  double area = 0, width = 1;
  double truncation = 0;
  /// To be met and mapped, from the survival function and the mean excess of the traces at `truncation`.
  [[nodiscard]] double chance(double survival, double excess) const noexcept;
};

/// Maximum likelihood with censoring (Laslett 1982): densities, survival functions and their integrals for 2, 1, 0
/// ends, over E (A + b l). Empty when there is no complete or half complete length. Power laws take min as the smallest
/// and max as ten times the largest length.
[[nodiscard]] std::optional<Fit> fit_lengths(std::span<const SeenLength> lengths, const Meeting& meeting,
                                             Family family);

/// A positive figure of a fitted law (its mean, say) with the interval of the delta method on the logarithm. `figure`
/// returns empty where the law has no such figure; without `moved` the interval is empty, too (low = 0, high infinite).
[[nodiscard]] Estimate estimate_of(const Fit& fit, std::string name,
                                   const std::function<std::optional<double>(const Fit&)>& figure,
                                   double confidence = 0.95);
[[nodiscard]] double std_of(const Fit& fit);
/// The parameters a and b themselves (b only where it is fitted): positive ones as `estimate_of`, mu of the lognormal
/// law with a symmetric interval.
[[nodiscard]] std::vector<Estimate> parameters_of(const Fit& fit, double confidence = 0.95);

/// Complete data (spacings): maximum likelihood, Kolmogorov-Smirnov p-value by parametric bootstrap with refitting
/// (`resamples`; 0: none).
[[nodiscard]] std::optional<Fit> fit_complete(std::span<const double> values, Family family, std::uint32_t resamples,
                                              std::uint64_t seed);

/// Chi-squared test against equal-probability bins with at least 5 expected each; `p_low`, `p_high`: p-values with
/// bins - 1 - fitted and bins - 1 degrees of freedom, between which the true one lies for a law fitted to unbinned
/// data.
struct ChiSquared {
  double statistic = 0, p_low = 1, p_high = 1;
  std::size_t bins = 0;
};
[[nodiscard]] ChiSquared chi_squared(std::span<const double> values, const Fit& fit);

/// A trace that lies wholly in a window, and how long the part of its line is that the window shows around it.
struct WholeTrace {
  double length = 0, chord = 0;
};
/// Whether the lengths of whole traces can be of one law of the family. Given the chord c a trace within it has the
/// density f(l) (c - l) above `truncation`, whatever its direction (centres are a Poisson process), so the others, cut
/// off, need not be known. The law is fitted to a random half, then all are compared with it: so the Kolmogorov-Smirnov
/// distance has the textbook's law although parameters are fitted (Durbin 1973, Stephens 1978). Empty for fewer than 20
/// traces and for power laws, whose limits are the data's; of more than 1,000 a random part is taken.
struct LengthTest {
  double distance = 0, p_value = 1;
  std::size_t traces = 0;
};
[[nodiscard]] std::optional<LengthTest> test_lengths(std::span<const WholeTrace> traces, double truncation,
                                                     Family family, std::uint64_t seed);

using MapPoint = Vec2;
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

/// Ends inside a window that its border has cut off, as it seems: more of them lie near it than by chance, as dense as
/// farther in. None: 0. Maps of more than 20,000 traces are not looked at.
struct CutOffEnds {
  std::size_t ends = 0;
  Length within = {};    ///< of the border
  double by_chance = 0;  ///< so many would be expected there
  Length border = {};    ///< a distance that takes all of them, with room for those digitised worse
};
[[nodiscard]] CutOffEnds cut_off_by_border(const Window& window, std::span<const Polyline> traces);

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
/// times the largest as limits. All of one size: the density has a pole at that of the longest trace, which integrates;
/// median and spread on the logarithm of the posterior with the prior 1/D, and no better than 0.25 %, how well ends of
/// traces are placed.
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

// Joints along scanlines and boreholes.

/// N joints on a length L: N/L with the exact Poisson interval (Garwood 1936). Unbiased for every L.
[[nodiscard]] Estimate frequency(std::size_t joints, double length, double confidence = 0.95);
/// Rock quality designation, %: 100 (1 + lambda t) e^-(lambda t) (Priest & Hudson 1976), and measured: the share of the
/// line in pieces of t and more, those at its ends included.
[[nodiscard]] double rqd_of_frequency(double frequency, double threshold = 0.1);
[[nodiscard]] double rqd_measured(std::span<const double> pieces, double length, double threshold = 0.1);
/// Both with intervals. Measured: a share made of independent pieces (beta law of the variance that the delta method
/// gives, with half a piece more; few short pieces: a gamma law); covers 94 to 98 % of Poisson lines, 99 % where less
/// than one short piece is expected. From the frequency: by its exact interval (RQD falls with it).
[[nodiscard]] Estimate rqd(std::span<const double> pieces, double length, double confidence = 0.95);
[[nodiscard]] Estimate rqd(const Estimate& frequency);

/// What the joints at these positions cut a line of this length into, from end to end.
[[nodiscard]] std::vector<double> pieces_of(std::vector<double> positions, double length);

}  // namespace cleave::survey
