#pragma once

#include <span>
#include <vector>

#include "cleave/survey/traces.hpp"

/// Frequencies and spacings along scanlines and boreholes.
namespace cleave::survey {

/// Mean of the complete gaps between joints on lines of length L, times the frequency lambda; y = lambda L. Gaps fit on
/// the line only in L - x places: E = [y - 2 + (y + 2) e^-y]/[y - 1 + e^-y]/lambda.
[[nodiscard]] double mean_gap_share(double y);
/// The same over lines of these lengths, each with as many gaps as it has on average.
[[nodiscard]] double mean_gap_share(double frequency, std::span<const double> lengths);
/// lambda from the mean of complete gaps and L; empty when no lambda gives it (mean >= L/3).
[[nodiscard]] Estimate frequency_from_gaps(std::span<const double> gaps, double length, double confidence = 0.95);
/// For comparison only: the thesis's correction (A.3, A.4) by an exponential law cut at L, which is biased.
[[nodiscard]] Estimate frequency_by_truncated_exponential(std::span<const double> gaps, double length,
                                                          double confidence = 0.95);

/// Gaps between the sorted positions.
[[nodiscard]] std::vector<double> gaps_of(std::vector<double> positions);

}  // namespace cleave::survey
