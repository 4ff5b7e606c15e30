#pragma once

/// Distribution functions and quantiles that statistics needs, and quadrature. Thin over Boost.Math, which stays out of
/// every header; no exceptions: arguments outside their range are a failed assertion, results beyond double are
/// infinite.

#include <cstddef>
#include <cstdint>
#include <vector>

namespace cleave::special {

/// Student's t: the value that a t variate with `degrees` > 0 falls below with probability p in (0, 1).
[[nodiscard]] double student_t_quantile(double p, double degrees);
[[nodiscard]] double normal_cdf(double z);
[[nodiscard]] double normal_density(double z);
/// Chi-squared with `degrees` > 0: quantile for p in [0, 1), and the probability of more than x.
[[nodiscard]] double chi_squared_quantile(double p, double degrees);
[[nodiscard]] double chi_squared_above(double x, double degrees);
/// Beta law with a, b > 0: quantile for p in [0, 1].
[[nodiscard]] double beta_quantile(double p, double a, double b);
/// P(B <= k) of B binomial(n, p), p in [0, 1].
[[nodiscard]] double binomial_cdf(std::uint64_t k, std::uint64_t n, double p);
/// Regularised incomplete gamma functions P(a, x) and Q = 1 - P, a > 0, x >= 0; and the x with P(a, x) = p or Q(a, x) =
/// q.
[[nodiscard]] double gamma_below(double a, double x);
[[nodiscard]] double gamma_above(double a, double x);
[[nodiscard]] double gamma_below_inverse(double a, double p);
[[nodiscard]] double gamma_above_inverse(double a, double q);
/// ln Gamma(x), x > 0, and its first derivative.
[[nodiscard]] double log_gamma(double x);
[[nodiscard]] double digamma(double x);

/// Points and weights of quadrature on [-1, 1].
struct GaussRule {
  std::vector<double> s;  ///< in (-1, 1), ascending
  std::vector<double> w;
};
/// Gauss-Legendre with n points, 1 <= n <= 64, to full precision; made once a program.
[[nodiscard]] const GaussRule& gauss_rule(std::size_t n);

}  // namespace cleave::special
