#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "cleave/core/rng.hpp"
#include "cleave/survey/comparison.hpp"
#include "cleave/survey/traces.hpp"
#include "maximum_likelihood.hpp"

namespace cleave::survey {
namespace {

constexpr double tiny = 1e-300;

/// Integral of f(l) (chord - l) from 0 to x.
double places_below(const Fit& law, double mean, double chord, double x) {
  const double below = law.below(x);
  return chord * below - (mean - law.mean_excess(x) - x * (1 - below));
}

double log_likelihood(const Fit& law, std::span<const WholeTrace> traces, double truncation) {
  const double mean = law.moment(1);
  double sum = 0;
  for (const auto& [length, chord] : traces) {
    const double all =
        places_below(law, mean, chord, chord) - (truncation > 0 ? places_below(law, mean, chord, truncation) : 0);
    sum += std::log(std::max(law.density(length), tiny)) - std::log(std::max(all, tiny));
  }
  return sum;
}

}  // namespace

std::optional<LengthTest> test_lengths(std::span<const WholeTrace> all, double truncation, Family family,
                                       std::uint64_t seed) {
  if (family == Family::power) return std::nullopt;
  std::vector<WholeTrace> traces;
  for (const WholeTrace& t : all) {
    if (t.length > 0 && t.length >= truncation && t.length < t.chord) traces.push_back(t);
  }
  constexpr std::size_t least = 20, most = 1000;
  if (traces.size() < least) return std::nullopt;
  // In random order: the first half is fitted; of very many a part is enough.
  Rng rng{{.seed = seed, .realization = 2, .purpose = 0xfffffffeU}};
  for (std::size_t i = traces.size() - 1; i > 0; --i) {
    const auto other = static_cast<std::size_t>(rng.uniform() * static_cast<double>(i + 1));
    std::swap(traces[i], traces[std::min(other, i)]);
  }
  traces.resize(std::min(traces.size(), most));
  const std::span<const WholeTrace> half = std::span{traces}.first(traces.size() / 2);
  double sum = 0;
  for (const WholeTrace& t : half) sum += t.length;
  const auto law_of = [&](std::array<double, 2> p) {
    if (detail::parameters(family) == 1) p[1] = 0;
    return detail::law_at(family, p, 0, 0);
  };
  const auto loss = [&](const std::array<double, 2>& p) {
    const double extra = detail::parameters(family) == 1 ? p[1] * p[1] : 0;  // an unused variable is drawn to 0
    const double l = -log_likelihood(law_of(p), half, truncation) + extra;
    return std::isfinite(l) ? l : 1e300;
  };
  const Fit law = law_of(detail::minimum(detail::start_of(family, sum / static_cast<double>(half.size())), loss));
  const double mean = law.moment(1);
  std::vector<double> shares;
  for (const auto& [length, chord] : traces) {
    const double before = truncation > 0 ? places_below(law, mean, chord, truncation) : 0;
    const double whole = places_below(law, mean, chord, chord) - before;
    shares.push_back(whole > tiny ? (places_below(law, mean, chord, length) - before) / whole : 1);
  }
  std::ranges::sort(shares);
  const auto n = static_cast<double>(shares.size());
  LengthTest test{.distance = 0, .p_value = 1, .traces = shares.size()};
  for (std::size_t i = 0; i < shares.size(); ++i) {
    const auto k = static_cast<double>(i);
    test.distance = std::max({test.distance, shares[i] - k / n, (k + 1) / n - shares[i]});
  }
  test.p_value = textbook_p_value(test.distance, shares.size());
  return test;
}

}  // namespace cleave::survey
