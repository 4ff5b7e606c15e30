#include "seepage.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

namespace cleave::flow {
namespace {

using Row = Eigen::Index;

/// What leaves at held numbers, and how much of it is no more than rounding.
struct Leaving {
  std::vector<double> out, rounding;
};
Leaving leaving(const Equations& equations, const Seepage& seepage) {
  const std::size_t count = equations.space.count;
  Leaving leaving{.out = std::vector<double>(count, 0), .rounding = std::vector<double>(count, 0)};
  const double largest = seepage.heads.size() > 0 ? seepage.heads.cwiseAbs().maxCoeff() : 0;
  for (std::size_t t = 0; t < equations.space.of.size(); ++t) {
    if (equations.wet[t] == 0) continue;
    const auto& own = equations.space.of[t];
    for (std::size_t i = 0; i < 3; ++i) {
      if (seepage.held[own[i]] == 0) continue;
      for (const std::size_t j : {(i + 1) % 3, (i + 2) % 3}) {
        const double s = equations.space.factor * equations.stiffness[t][3 - i - j];
        const double drop = seepage.heads(Row{own[j]}, 0) - seepage.heads(Row{own[i]}, 0);
        leaving.out[own[i]] -= s * drop;
        leaving.rounding[own[i]] += std::abs(s) * (1e-12 * std::abs(drop) + 1e-15 * largest);
      }
    }
  }
  return leaving;
}

/// Numbers that are held though water would go in, or free though they lie above the ceiling.
std::vector<Index> misplaced(const Equations& equations, const Ceiling& ceiling, const Seepage& seepage) {
  const Leaving water = leaving(equations, seepage);
  std::vector<Index> found;
  for (Index n = 0; n < equations.space.count; ++n) {
    if (!std::isfinite(ceiling.at[n])) continue;
    const bool takes_in = seepage.held[n] != 0 && water.out[n] < -water.rounding[n];
    const bool above = seepage.held[n] == 0 && seepage.heads(Row{n}, 0) > ceiling.at[n] + ceiling.near;
    if (takes_in || above) found.push_back(n);
  }
  return found;
}

bool fill(const Equations& equations, std::span<const std::uint8_t> standing, const Ceiling& ceiling,
          Seepage& seepage) {
  std::vector<std::uint8_t> fixed(standing.begin(), standing.end());
  for (Index n = 0; n < equations.space.count; ++n) {
    if (seepage.held[n] == 0) continue;
    fixed[n] = 1;
    seepage.heads(Row{n}, 0) = ceiling.at[n];
  }
  seepage.equations =
      std::make_shared<const LeastEnergy>(equations.space, equations.stiffness, equations.wet, std::move(fixed));
  const auto residual = seepage.equations->fill(seepage.heads);
  if (residual) seepage.residual = std::max(seepage.residual, *residual);
  return residual.has_value();
}

}  // namespace

bool settle(const Equations& equations, std::span<const std::uint8_t> standing, const Ceiling& ceiling, bool solved,
            Seepage& guess) {
  // All that are misplaced are turned at once, which takes few passes; where their number does not fall any more, one
  // at a time until it does, which comes to an end (Murty 1974, Judice and Pires 1994).
  constexpr int most = 400, patience = 8;
  std::size_t fewest = SIZE_MAX;
  int left = patience;
  guess.settled = false;
  for (int pass = 0; pass < most; ++pass) {
    if ((pass > 0 || !solved) && !fill(equations, standing, ceiling, guess)) return false;
    std::vector<Index> wrong = misplaced(equations, ceiling, guess);
    if (wrong.empty()) {
      guess.settled = true;
      return true;
    }
    if (wrong.size() < fewest) {
      fewest = wrong.size();
      left = patience;
    } else if (left > 0) {
      --left;
    } else {
      wrong = {wrong.back()};
    }
    for (const Index n : wrong) guess.held[n] = guess.held[n] != 0 ? 0 : 1;
  }
  return fill(equations, standing, ceiling, guess);
}

}  // namespace cleave::flow
