#pragma once

#include <span>
#include <vector>

#include "cleave/survey/traces.hpp"

/// Frequencies and spacings along scanlines and boreholes.
namespace cleave::survey {

/// N joints on a length L: N/L with the exact Poisson interval (Garwood 1936). Unbiased for every L.
[[nodiscard]] Estimate frequency(std::size_t joints, double length, double confidence = 0.95);

/// Mean of the complete gaps between joints on lines of length L, times the frequency lambda; y = lambda L. Gaps fit on
/// the line only in L - x places: E = [y - 2 + (y + 2) e^-y]/[y - 1 + e^-y]/lambda.
[[nodiscard]] double mean_gap_share(double y);
/// lambda from the mean of complete gaps and L; empty when no lambda gives it (mean >= L/3).
[[nodiscard]] Estimate frequency_from_gaps(std::span<const double> gaps, double length, double confidence = 0.95);
/// For comparison only: the thesis's correction (A.3, A.4) by an exponential law cut at L, which is biased.
[[nodiscard]] Estimate frequency_by_truncated_exponential(std::span<const double> gaps, double length,
                                                          double confidence = 0.95);

/// Rock quality designation, %: 100 (1 + lambda t) e^-(lambda t) (Priest & Hudson 1976), and measured: the share of the
/// line in pieces of t and more, those at its ends included.
[[nodiscard]] double rqd_of_frequency(double frequency, double threshold = 0.1);
[[nodiscard]] double rqd_measured(std::span<const double> pieces, double length, double threshold = 0.1);
/// Both with intervals. Measured: a share made of independent pieces (beta law of the variance that the delta method
/// gives, with half a piece more; few short pieces: a gamma law); covers 94 to 98 % of Poisson lines, 99 % where less
/// than one short piece is expected. From the frequency: by its exact interval (RQD falls with it).
[[nodiscard]] Estimate rqd(std::span<const double> pieces, double length, double confidence = 0.95);
[[nodiscard]] Estimate rqd(const Estimate& frequency);

/// Gaps between the sorted positions.
[[nodiscard]] std::vector<double> gaps_of(std::vector<double> positions);
/// What the joints at these positions cut a line of this length into, from end to end.
[[nodiscard]] std::vector<double> pieces_of(std::vector<double> positions, double length);

}  // namespace cleave::survey
