#include "cleave/core/special.hpp"

#include <boost/math/distributions/students_t.hpp>
#include <boost/math/special_functions/beta.hpp>
#include <boost/math/special_functions/digamma.hpp>
#include <boost/math/special_functions/gamma.hpp>
#include <cmath>
#include <numbers>

#include "cleave/core/assert.hpp"

namespace cleave::special {
namespace {

using namespace boost::math::policies;
/// No exceptions, and no long double inside: the same bits wherever double is IEEE.
using Quiet = policy<domain_error<ignore_error>, pole_error<ignore_error>, overflow_error<ignore_error>,
                     underflow_error<ignore_error>, evaluation_error<ignore_error>, rounding_error<ignore_error>,
                     promote_double<false>>;

}  // namespace

double student_t_quantile(double p, double degrees) {
  CLEAVE_ASSERT(p > 0 && p < 1 && degrees > 0);
  return quantile(boost::math::students_t_distribution<double, Quiet>{degrees}, p);
}

double normal_cdf(double z) { return 0.5 * std::erfc(-z / std::numbers::sqrt2); }

double normal_density(double z) { return std::exp(-z * z / 2) / std::sqrt(2 * std::numbers::pi); }

double chi_squared_quantile(double p, double degrees) {
  CLEAVE_ASSERT(p >= 0 && p < 1 && degrees > 0);
  return 2 * gamma_below_inverse(degrees / 2, p);
}

double chi_squared_above(double x, double degrees) {
  CLEAVE_ASSERT(degrees > 0);
  return x <= 0 ? 1 : gamma_above(degrees / 2, x / 2);
}

double beta_quantile(double p, double a, double b) {
  CLEAVE_ASSERT(p >= 0 && p <= 1 && a > 0 && b > 0);
  return boost::math::ibeta_inv(a, b, p, Quiet{});
}

double binomial_cdf(std::uint64_t k, std::uint64_t n, double p) {
  CLEAVE_ASSERT(p >= 0 && p <= 1);
  if (k >= n) return 1;
  return boost::math::ibetac(static_cast<double>(k) + 1, static_cast<double>(n - k), p, Quiet{});
}

double gamma_below(double a, double x) { return boost::math::gamma_p(a, x, Quiet{}); }
double gamma_above(double a, double x) { return boost::math::gamma_q(a, x, Quiet{}); }
double gamma_below_inverse(double a, double p) { return boost::math::gamma_p_inv(a, p, Quiet{}); }
double gamma_above_inverse(double a, double q) { return boost::math::gamma_q_inv(a, q, Quiet{}); }
double log_gamma(double x) { return boost::math::lgamma(x, Quiet{}); }
double digamma(double x) { return boost::math::digamma(x, Quiet{}); }

}  // namespace cleave::special
