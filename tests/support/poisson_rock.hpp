#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "cleave/core/rng.hpp"
#include "cleave/stochastic/ensemble.hpp"

/// Rock cut by three orthogonal sets of persistent joints, each a Poisson process of spacing 1 m: the volume of a block
/// is a product of three unit exponentials, exactly.
namespace cleave::support {

/// Share of the blocks larger than v, by number. P(XY > u) = 2 sqrt(u) K1(2 sqrt(u)).
inline double poisson_rock_above_by_number(double v);
/// By volume: three sizes drawn in proportion to themselves, Gamma(2).
inline double poisson_rock_above_by_volume(double v);

namespace detail {
/// Integral over x > 0 of f(x), x = e^t.
template <class F>
double integral(F f) {
  constexpr double from = -40, to = 5, step = 0.01;
  double sum = 0;
  for (double t = from; t < to; t += step) sum += f(std::exp(t)) * std::exp(t);
  return sum * step;
}
template <class F>
double quantile(F above, double p) {
  double low = 1e-9, high = 1e4;
  for (int i = 0; i < 60; ++i) {
    const double middle = std::sqrt(low * high);
    (1 - above(middle) < p ? low : high) = middle;
  }
  return std::sqrt(low * high);
}
}  // namespace detail

inline double poisson_rock_above_by_number(double v) {
  return detail::integral([v](double x) {
    const double s = std::sqrt(v / x);
    return s > 300 ? 0 : std::exp(-x) * 2 * s * std::cyl_bessel_k(1.0, 2 * s);
  });
}
inline double poisson_rock_above_by_volume(double v) {
  return detail::integral([v](double x) {
    const double u = v / x, s = std::sqrt(u);
    if (s > 300) return 0.0;
    return x * std::exp(-x) * (2 * u * std::cyl_bessel_k(2.0, 2 * s) + 2 * u * s * std::cyl_bessel_k(1.0, 2 * s));
  });
}

/// The volumes at `stochastic::size_levels`.
struct PoissonRockTruth {
  std::array<double, stochastic::size_levels.size()> by_number{}, by_volume{};
};
inline const PoissonRockTruth& poisson_rock_truth() {
  static const PoissonRockTruth truth = [] {
    PoissonRockTruth t;
    for (std::size_t i = 0; i < stochastic::size_levels.size(); ++i) {
      const double p = stochastic::size_levels.at(i).second;
      t.by_number.at(i) = detail::quantile(poisson_rock_above_by_number, p);
      t.by_volume.at(i) = detail::quantile(poisson_rock_above_by_volume, p);
    }
    return t;
  }();
  return truth;
}

/// One realization in a box of `side` m. Without `corrected` each block counts once.
inline stochastic::Record poisson_rock(double side, std::uint64_t sample, std::uint64_t k, bool corrected = true) {
  Rng rng{{.seed = 91, .realization = sample, .purpose = 1, .index = static_cast<std::uint32_t>(k)}};
  std::array<std::vector<double>, 3> gaps;
  stochastic::Record r;
  r.realization = k;
  r.rock_m3 = side * side * side;
  for (auto& own : gaps) {
    double last = 0, joints = 0;
    for (double at = -std::log(rng.uniform()); at < side; at -= std::log(rng.uniform())) {
      if (joints++ > 0) own.push_back(at - last);
      last = at;
    }
    r.sets.push_back({joints, joints / side, joints / side, joints / side});
  }
  std::vector<std::pair<double, double>> blocks;
  for (const double a : gaps[0]) {
    for (const double b : gaps[1]) {
      for (const double c : gaps[2]) {
        const double weight = side / (side - a) * side / (side - b) * side / (side - c);
        blocks.emplace_back(a * b * c, corrected ? weight : 1);
      }
    }
  }
  std::ranges::sort(blocks);
  stochastic::RockSizes& sizes = r.sizes.emplace();
  sizes.blocks = r.blocks = blocks.size();
  double number = 0, volume = 0;
  for (const auto& [v, weight] : blocks) {
    const std::uint32_t bin = stochastic::SizeBin::of(v);
    if (sizes.bins.empty() || sizes.bins.back().bin != bin) sizes.bins.push_back({.bin = bin});
    sizes.bins.back().number += static_cast<float>(weight);
    sizes.bins.back().volume_m3 += static_cast<float>(weight * v);
    sizes.volume_m3 += static_cast<float>(v);
    sizes.shapes[0] += static_cast<float>(weight);
    number += weight;
    volume += weight * v;
  }
  for (std::size_t i = 0; i < stochastic::size_levels.size(); ++i) {
    const double p = stochastic::size_levels.at(i).second;
    double number_passed = 0, volume_passed = 0;
    for (const auto& [v, weight] : blocks) {
      if (number_passed < p * number) sizes.by_number.at(i) = static_cast<float>(v);
      if (volume_passed < p * volume) sizes.by_volume.at(i) = static_cast<float>(v);
      number_passed += weight;
      volume_passed += weight * v;
    }
  }
  return r;
}

inline stochastic::EnsembleOptions poisson_rock_options(double confidence = 0.95) {
  return {.stability = false,
          .confidence = confidence,
          .volumes_m3 = {},
          .tunnel_length_m = {},
          .sets = {"across", "along", "level"}};
}

inline stochastic::Figures poisson_rock_figures(double side, std::uint64_t sample, std::uint64_t realizations,
                                                double confidence = 0.95, bool corrected = true) {
  stochastic::Ensemble ensemble{poisson_rock_options(confidence)};
  for (std::uint64_t k = 0; k < realizations; ++k) ensemble.add(poisson_rock(side, sample, k, corrected), "");
  return ensemble.figures();
}

}  // namespace cleave::support
