#pragma once

#include <optional>
#include <string>

#include "cleave/survey/fit.hpp"

/// Joint size from trace length (Warburton 1980, Zhang & Einstein 2000).
namespace cleave::survey {

/// E D^(k+1)/E D over E_g l^k: integral of sin^k over a quarter turn; J_1..J_4 = 1, pi/4, 2/3, 3 pi/16.
[[nodiscard]] double quarter_sine(int k);

/// Law of the diameters of discs from mean and second moment of true trace lengths on a plane.
struct DiscLaw {
  Family family = Family::exponential;
  double mean = 0, std = 0;
};
/// Distribution-free: E D^2/E D = 4 mean/pi and E D^3/E D = 3 second/2; shape ratio m3/m2^2 >= 1 for every law of
/// discs.
struct DiscMoments {
  double m2 = 0, m3 = 0;
  [[nodiscard]] double ratio() const noexcept { return m3 / (m2 * m2); }
};
[[nodiscard]] DiscMoments disc_moments(double mean_length, double second_moment) noexcept;
/// Empty when no law of the family has these moments: the ratio is below 1, or 2 or more for gamma. The exponential law
/// takes the mean alone.
[[nodiscard]] std::optional<DiscLaw> disc_law(Family family, double mean_length, double second_moment);
/// Mean and standard deviation of the diameters that a fitted law of trace lengths implies, with intervals from the
/// fit's own; values empty where no law of discs has such traces.
[[nodiscard]] Estimate disc_mean(const Fit& lengths, double confidence = 0.95);
[[nodiscard]] Estimate disc_std(const Fit& lengths, double confidence = 0.95);
/// E l^3 of the traces that the law implies, (3 pi/16) E D^4/E D: for choosing among laws.
[[nodiscard]] double third_moment(const DiscLaw& law);
/// E D^k of the law.
[[nodiscard]] double diameter_moment(const DiscLaw& law, int k);

/// Ellipse with axes a >= a/k seen along a trace at `beta` (radians) from the long axis in its plane: chords are those
/// of a disc of diameter M a (Zhang, Einstein & Dershowitz 2002).
[[nodiscard]] double ellipse_factor(double aspect, double beta);

/// Chords of a parallelogram (Warburton 1980b): longest chord, share of chords that have it, mean.
struct ParallelogramChords {
  double longest = 0, share_longest = 0, mean = 0;
};
[[nodiscard]] ParallelogramChords parallelogram_chords(double p, double q, double angle_p, double angle_q);

}  // namespace cleave::survey
