#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "cleave/survey/traces.hpp"

/// Formulas of Fu (2014), appendix A, that are biased or ask for more than they need. For comparison only:
/// each says so in its note, and no other figure is made of them.
namespace cleave::survey {

/// Mean trace length A (1 + q)/(b (1 - q)), q = (n0 - n2)/(N + 1) (Pahl 1981, A.11): parallel traces, and the 1 keeps
/// it finite where no end is seen, at the price of a bias.
[[nodiscard]] Estimate mean_length_by_pahl(const WindowCounts& c, double confidence = 0.95);
/// Mean trace length in a circle from how many traces were seen and the length inside, pi R S/(pi R N - 2 S) (of the
/// kind of Andersson & Dverstorp 1987, A.13).
[[nodiscard]] Estimate mean_length_by_number(const WindowCounts& c, double confidence = 0.95);
/// Traces per area, each counted by the chance that its midpoint lies in the window (Kulatilake & Wu 1984, A.26): needs
/// the law of the lengths.
[[nodiscard]] Estimate p20_by_midpoints(std::span<const SeenLength> lengths, const Fit& law, double area,
                                        double confidence = 0.95);

/// Spread of the trace lengths when that of the pieces seen is taken for it: their standard deviation (Kulatilake et
/// al. 1993), their coefficient of variation with the mean 2S/m (Zhang & Einstein 2000), and the lognormal law of sizes
/// that follows from the latter. Intervals leave out one trace after the other.
[[nodiscard]] std::vector<Estimate> spread_as_measured(std::span<const SeenLength> lengths, const Chords& chords,
                                                       double confidence = 0.95);

/// Kolmogorov-Smirnov p-value of the textbook, with Stephens' (1970) correction for few data: as if the law had not
/// been fitted to the same n data, so too large.
[[nodiscard]] double textbook_p_value(double distance, std::size_t n);

}  // namespace cleave::survey
