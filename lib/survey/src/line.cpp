#include "line.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "cleave/core/rng.hpp"
#include "cleave/core/special.hpp"

namespace cleave::survey {
namespace {

double mean_of(std::span<const double> x) {
  return std::accumulate(x.begin(), x.end(), 0.0) / static_cast<double>(x.size());
}

}  // namespace

Estimate frequency(std::size_t joints, double length, double confidence) {
  const auto n = static_cast<double>(joints);
  const double a = (1 - confidence) / 2;
  Estimate e{"frequency", n / length, 0, 0, "N/L, exact Poisson interval", ""};
  e.low = joints == 0 ? 0 : special::chi_squared_quantile(a, 2 * n) / (2 * length);
  e.high = special::chi_squared_quantile(1 - a, 2 * n + 2) / (2 * length);
  return e;
}

double mean_gap_share(double y) {
  if (y < 1e-3) return y / 3;  // leading term
  return (y - 2 + (y + 2) * std::exp(-y)) / (y - 1 + std::exp(-y));
}

double mean_gap_share(double frequency, std::span<const double> lengths) {
  double sum = 0, gaps = 0;
  for (const double length : lengths) {
    const double y = frequency * length, number = y < 1e-3 ? y * y / 2 : y - 1 + std::exp(-y);
    sum += number * mean_gap_share(y);
    gaps += number;
  }
  return sum / gaps;
}

Estimate frequency_from_gaps(std::span<const double> gaps, double length, double confidence) {
  Estimate e{"frequency", {}, 0, 0, "mean of complete gaps, corrected for the line's length", ""};
  if (gaps.empty()) {
    e.note = "no complete gap";
    return e;
  }
  const double mean = mean_of(gaps);
  const auto solve = [&](double m) -> std::optional<double> {
    // mean_gap_share(lambda L)/lambda falls from L/3 with lambda.
    if (!(m > 0) || m >= length / 3) return std::nullopt;
    double low = 1e-9 / length, high = 10 / m;
    for (int i = 0; i < 200; ++i) {
      const double middle = std::sqrt(low * high);
      (mean_gap_share(middle * length) / middle > m ? low : high) = middle;
    }
    return std::sqrt(low * high);
  };
  e.value = solve(mean);
  if (!e.value) {
    e.note = "the gaps are too long for the line: measure on a longer one";
    return e;
  }
  const double z = normal_quantile(0.5 + confidence / 2) / std::sqrt(static_cast<double>(gaps.size()));
  e.low = solve(mean * std::exp(z)).value_or(0);
  e.high = solve(mean * std::exp(-z)).value_or(INFINITY);
  return e;
}

Estimate frequency_by_truncated_exponential(std::span<const double> gaps, double length, double confidence) {
  Estimate e{"frequency", {}, 0, 0, "exponential law cut at L (thesis A.3, A.4)", "biased; for comparison only"};
  if (gaps.empty()) return e;
  const auto solve = [&](double m) -> std::optional<double> {
    if (!(m > 0) || m >= length / 2) return std::nullopt;
    double low = 1e-9 / length, high = 10 / m;
    for (int i = 0; i < 200; ++i) {
      const double l = std::sqrt(low * high), y = l * length;
      const double share = y < 1e-6 ? y / 2 : (1 - (1 + y) * std::exp(-y)) / -std::expm1(-y);
      (share / l > m ? low : high) = l;
    }
    return std::sqrt(low * high);
  };
  const double mean = mean_of(gaps);
  e.value = solve(mean);
  if (!e.value) return e;
  const double z = normal_quantile(0.5 + confidence / 2) / std::sqrt(static_cast<double>(gaps.size()));
  e.low = solve(mean * std::exp(z)).value_or(0);
  e.high = solve(mean * std::exp(-z)).value_or(INFINITY);
  return e;
}

double rqd_of_frequency(double frequency, double threshold) {
  const double y = frequency * threshold;
  return 100 * (1 + y) * std::exp(-y);
}

namespace {

/// Pieces as long as the threshold count (ISRM 1978), whatever rounding leaves of the difference of two positions.
bool counts(double piece, double threshold) { return piece >= (1 - 1e-9) * threshold; }

}  // namespace

double rqd_measured(std::span<const double> pieces, double length, double threshold) {
  double sum = 0;
  for (const double g : pieces) sum += counts(g, threshold) ? g : 0;
  return 100 * sum / length;
}

namespace {

/// Upper bound of a sum of few random parts of at most about `part`: gamma law with half a part more, and its spread.
double few_parts(double level, double sum, double square, double part) {
  const double v = square + part * part / 2, y = sum + part / 2;
  return v / (2 * y) * special::chi_squared_quantile(level, 2 * y * y / v);
}

/// Of a share made of independent parts (its sum, and the sum of squares of how far each is off its share): beta law
/// with half a part more.
double share_quantile(double level, double sum, double square, double part, double whole) {
  const double p = (sum + part / 2) / (whole + part);
  const double effective = p * (1 - p) * whole * whole / (square + part * part / 4);
  return special::beta_quantile(level, p * effective, (1 - p) * effective);
}

}  // namespace

Estimate rqd(std::span<const double> pieces, double length, double confidence) {
  constexpr double threshold = 0.1;
  Estimate e{"RQD", rqd_measured(pieces, length, threshold), 0, 100, "pieces of 0.1 m and more / length, beta law", ""};
  const double kept = *e.value / 100, number = static_cast<double>(pieces.size());
  // The rarer of both, kept or lost, decides how well the share is known.
  const bool lost = kept > 0.5;
  const double sum = length * (lost ? 1 - kept : kept), part = lost ? threshold : threshold + length / number;
  double square = 0, few = 0;
  for (const double piece : pieces) {
    const double off = (counts(piece, threshold) ? piece : 0) - kept * piece;
    square += off * off;
    few += counts(piece, threshold) != lost ? 1 : 0;
  }
  const double low_level = (1 - confidence) / 2, high_level = 1 - low_level;
  double low = share_quantile(low_level, sum, square, part, length),
         high = share_quantile(high_level, sum, square, part, length);
  constexpr double too_few = 2;  // below: the beta law says too much of where the share begins
  if (lost && few <= too_few) {
    const double least =
        sum > 0 ? square / (2 * sum) * special::chi_squared_quantile(low_level, 2 * sum * sum / square) : 0;
    low = std::min(low, least / length);
    high = std::max(high, few_parts(high_level, sum, square, part) / length);
  }
  e.low = std::max(0.0, 100 * (lost ? 1 - high : low));
  e.high = std::min(100.0, 100 * (lost ? 1 - low : high));
  return e;
}

Estimate rqd(const Estimate& frequency) {
  Estimate e{"RQD", {}, 0, 100, "100 (1 + 0.1 lambda) exp(-0.1 lambda), interval of lambda", ""};
  if (!frequency.value) return e;
  e.value = rqd_of_frequency(*frequency.value);
  e.low = rqd_of_frequency(frequency.high);
  e.high = rqd_of_frequency(frequency.low);
  return e;
}

std::vector<double> gaps_of(std::vector<double> positions) {
  std::ranges::sort(positions);
  std::vector<double> gaps;
  for (std::size_t i = 1; i < positions.size(); ++i) gaps.push_back(positions[i] - positions[i - 1]);
  return gaps;
}

std::vector<double> pieces_of(std::vector<double> positions, double length) {
  std::erase_if(positions, [&](double p) { return !(p > 0 && p < length); });
  positions.push_back(0);
  positions.push_back(length);
  return gaps_of(std::move(positions));
}

}  // namespace cleave::survey
