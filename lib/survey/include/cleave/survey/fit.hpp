#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace cleave::survey {

/// A figure of a survey with its confidence interval. `note` says how it came about or why it cannot be had.
struct Estimate {
  std::string name;
  std::optional<double> value;  ///< empty: not estimable
  double low = 0, high = 0;
  std::string method;
  std::string note;
};

/// a/b of two positive estimates that scatter independently: their half widths on the logarithm are added as squares.
[[nodiscard]] Estimate over(const Estimate& a, const Estimate& b, std::string name, std::string method);

// Laws fitted to lengths and spacings by maximum likelihood, with censoring.

enum class Family : std::uint8_t { exponential, lognormal, gamma, power, normal };
[[nodiscard]] std::string_view name_of(Family family) noexcept;

/// A fitted law. Parameters: exponential mean; lognormal mu, sigma of the logarithm; gamma shape, scale; power exponent
/// with the limits min, max; normal mu > 0 and sigma of the law before it is cut at 0.
struct Fit {
  Family family = Family::exponential;
  double a = 1, b = 1;
  double min = 0, max = 0;  ///< power only
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

}  // namespace cleave::survey
