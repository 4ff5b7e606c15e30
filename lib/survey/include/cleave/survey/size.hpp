#pragma once

#include <cstdint>
#include <numbers>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "cleave/survey/fit.hpp"

/// Joint size from trace length (Warburton 1980, Zhang & Einstein 2000).
namespace cleave::survey {

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
